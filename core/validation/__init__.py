"""Problems whose answers are known, for this or any other program: `vibrafeed validate`.

`problem` says what a problem is; `forms` makes them from formulas, `known` and `rail` from numbers
that stand elsewhere; `catalogue` puts them together. `run` answers them by this program's own
studies, `answers` reads another program's, and both are judged alike.
"""
