"""Unknown parameters from measured speeds: a posterior on its grid, and the next measurement."""
