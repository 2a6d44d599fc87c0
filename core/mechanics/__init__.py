"""Pure array functions that scenes share. They know arrays and nothing else."""
