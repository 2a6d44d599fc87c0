"""What every kind of study shares: plan, grid, evaluation, pieces, labels, sampled cells."""
