"""Event-driven motion in a vertical plane along the track (theory 13.2 to 13.8), compiled.

Scales: phase tau = w t, lengths g/w^2, velocities g/w, accelerations g. The drive accelerates the
part, in the frame of the track, by (c, s) sin(tau) or another wave; gravity by -(gs, gn). In every
mode the flow is closed, so a motion is a chain of events: lift-off, landing, stop, start of slip.
Each is isolated on a piece of its flow that bends one way only, where Newton's or Halley's
iteration runs to the root: none can be missed.

The motion normal to the floor knows nothing of friction. Its attractor is found first, as a chain
of segments (contact, flight) that repeats after whole periods; what is left is a map of one number,
the sliding velocity at the start of the chain, onto itself. Under one coefficient of friction it
never stretches distances, so its fixed point is bracketed by every evaluation.

`drive`: what a drive has to tell; `flow`, `sine_flight` and `sine_slip` tell it of a sine, `wave`,
`wave_flight` and `wave_slip` of any other; `cycle`: the chain of segments, and `growth`, how far
roundings grow along it; `slide`: the motion along the track over a chain; `settle`: the velocity at
which that repeats; `repeating`: its means; `chaos`: means of motion that does not, `within`, to a
tolerance, and `landings`, what cells have in common there; `solve`: one cell, and many;
`unrepeated`: cells without a cycle; `again`: the path of one part, and what friction, impacts and
the drive do over a cycle. `vibrafeed.core.motion.planar` says which of them Python calls. Each is
compiled for a sine and for other waves, which the type of `waves` tells.

A sine is the wave of one harmonic, and has forms of its own: with them a cell takes 5.0 us where it
slides and 6.6 us where it hops, as a wave of one harmonic 5.5 and 7.3 us, with rebounds 18 for 21
us (the least of 15 rounds over 1,070 random cells).
"""
