"""The report as HTML pages that open from disk: figures, claims, coefficients, interactive laws."""

from cylcontact.reports.html.site import Site, build_site

__all__ = ["Site", "build_site"]
