"""Motion in time: stick, slide, hop, and the true mean velocity over whole grids."""
