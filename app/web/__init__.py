"""The HTTP interface: routes, what stands around them, and what they reply."""
