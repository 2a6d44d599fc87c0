"""Studies whose results are known from elsewhere, and how far this or another program misses them.

`case` says what a case is, `judge` what becomes of it, `tables` shows outcomes. `forms` makes cases
from formulas, `worked` holds those whose numbers stand elsewhere, `hard_cases` those at the edge of
what numbers bear; `catalogue` puts them together. `accuracy` measures error against run time for a
user's own study, and `leaving_out` counts what a study does not compute.
"""
