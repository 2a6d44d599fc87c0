"""Error against run time, for the scene and the parameters of a user's study.

`precise` gives closed forms to 50 digits, `report` measures a study, `page` writes it down.
"""
