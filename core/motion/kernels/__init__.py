"""Compiled kernels, one file a system: the cache of compiled code looks at the date of one file."""
