"""Error against run time, for the scene and the parameters of a user's study.

`report` measures a study, `page` writes it down.
"""
