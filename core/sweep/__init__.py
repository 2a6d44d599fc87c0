"""Closed-form sweeps: from a study to a plan, a grid, and a labelled dataset."""
