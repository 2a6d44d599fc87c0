"""The compiled way of a plan: its equations traced, and written as one loop."""
