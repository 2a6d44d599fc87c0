"""Pictures of datasets: `pictures` lists them, and `drawing` draws them.

The only place that loads matplotlib, when a picture is drawn. Its object interface is used, never
`pyplot`: nothing here changes a global state, opens a window or picks a backend.
"""
