"""Answers over some axes of a grid of closed forms, box by box: no grid is ever stored."""
