"""Files in and out: how they are read and written, specs, units, journals and provenance."""
