"""Labelled results: CF attributes, rows, and files in every format."""
