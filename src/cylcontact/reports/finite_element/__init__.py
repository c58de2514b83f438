"""What the figures and claims of Section 3.2 show: finite elements beside the explicit laws."""
