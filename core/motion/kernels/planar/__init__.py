"""Event-driven motion in a vertical plane along the track (theory 13.2 to 13.8), compiled.

Scales: phase tau = w t in rad, lengths g/w^2, velocities g/w, accelerations g, w = 2 pi f. In every
mode the flow is closed, so a motion is a chain of events, each isolated on a piece of its flow that
bends one way only: none can be missed. The motion normal to the floor knows nothing of friction:
its cycle of segments (contact, flight) is found first; what is left is a map of the slip at its
start onto itself. A sine is the wave of one harmonic, with forms of its own that take 5.0 us a cell
where a wave takes 5.5, and 6.6 for 7.3 with hops.
"""
