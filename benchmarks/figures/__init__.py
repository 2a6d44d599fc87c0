"""Judges chapter 5 and draws its figures, for docs/generated: `python -m benchmarks.figures`.

Each claim of the source about a figure is put to the data of configs/figures, which hold the
formulas as printed. A function for each figure, or for each pair that shows the same data, measures
what the claim speaks of and decides from the numbers.
"""
