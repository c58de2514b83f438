"""What touches: materials, a pair of cylinders, and ISO fits of a pin in a hole."""
