"""Materials, pairs of cylinders, and ISO fits of a pin in a hole."""
