"""Parts that all kinds of studies share: plan, grid, evaluation, pieces, labels, sampled cells."""
