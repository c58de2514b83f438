"""Clearance joints as force elements in other languages: one module for each."""
