"""Loops over the cells of a box."""
