"""Studies as users write them, with their units and ranges."""
