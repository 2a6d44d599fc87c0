"""Compiled kernels of the optimiser, one file each."""
