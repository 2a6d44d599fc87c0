"""Compiled kernels, a package a method; of ours they import each other and flags only."""
