"""What Section 4's figures and claims are made of: runs of the mechanism, and how to draw them."""
