"""The atlas: the speed of planar motion without restitution, over the four numbers it depends on.

`numbers` are the four numbers, `cells` what is exact at them, `nodes` where the grid has its nodes,
`build` makes the table, `read` reads it back, `find` interpolates, and `lookup` does so for what a
user writes.
"""
