"""The report as pages that open from disk: figures, claims, coefficients, laws to play with."""

from cylcontact.reports.html.site import Site, build_site

__all__ = ["Site", "build_site"]
