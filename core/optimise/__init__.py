"""The best angles of the drive: exact answers, and a compiled solver for whole batches."""
