"""The results as pages of the documentation: which law to use, figures, fits, statements."""

from cylcontact.reports.pages.site import Site, build_site

__all__ = ["Site", "build_site"]
