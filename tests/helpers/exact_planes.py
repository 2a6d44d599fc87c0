"""Exact values of planes and track: the textbook formulas of the theory (sections 0.2, 3, 4, 7,
11.1), with so many digits that cancellation does not matter.

They share nothing with the code under test.
"""

import math

from many_digits import mp, mpf, root_between

DIGITS = 60
ZERO, EPSILON = mpf(0), mpf(2) ** -52


class Point:
    """Exact values at one point: `point.name` is an input, or is worked out by its formula, once.

    `fixed` are values that stand in for formulas, `used` the inputs that were asked for, `beside`
    the points a step in one input away.
    """

    def __init__(self, scene, variant, given, fixed=None):
        self.scene, self.variant, self.given = scene, variant, given
        self.fixed, self.used, self.beside = fixed or {}, set(), {}
        self.__dict__.update(self.fixed)
        self.physical, self.thesis = variant == "physical", variant == "thesis"

    def __getattr__(self, name):
        formula = FORMULAS[self.scene].get(name)
        if formula is None:
            self.used.add(name)
            return self.given[name]
        value = self.__dict__[name] = formula(self)
        return value


# --- drive, gravity and floor; sections 0.2, 3, 11.1


def exact_at_right_angles(function, values):
    """Return a function of an angle that takes the float of a multiple of 90 degrees as that."""
    known = {k * math.pi / 2: mpf(values[k % 4]) for k in range(-4, 5)}

    def of(angle):
        plain = float(angle)
        return known[plain] if plain in known and mpf(plain) == angle else function(angle)

    return of


sin = exact_at_right_angles(mp.sin, (0, 1, 0, -1))
cos = exact_at_right_angles(mp.cos, (1, 0, -1, 0))


def throw(drive, gravity):
    if gravity:
        return drive / gravity
    return mp.sign(drive) * mp.inf if drive else mp.nan


def sliding_fraction(p):
    if p.floor_acceleration == 0:
        return mpf(1)
    stuck = p.hold_margin >= 0
    return ZERO if stuck else 1 - p.friction_kinetic * p.floor_acceleration / p.in_plane_drive


def plane_acceleration(p, D):
    return D * p.sliding_fraction if p.physical else D - p.friction_kinetic * p.normal_acceleration


def pressure_offset(p, D, a):
    """Return b/2 F/N; the friction force F (per mass) is what keeps a from being D.

    On the track, floor and wall bear it in proportion to their normal forces.
    """
    return p.height / 2 * (D - a) / p.load if p.floor_acceleration else mp.nan


PLANE = {
    "vibration_acceleration": lambda p: p.amplitude * (2 * mp.pi * p.frequency) ** 2,
    "drive_along": lambda p: p.vibration_acceleration * cos(p.beta) * cos(p.alpha),
    "drive_across": lambda p: p.vibration_acceleration * cos(p.beta) * sin(p.alpha),
    "drive_normal": lambda p: p.vibration_acceleration * sin(p.beta),
    "gravity_along": lambda p: p.gravity * sin(p.gamma),
    "gravity_normal": lambda p: p.gravity * cos(p.gamma),
    "in_plane_drive_x": lambda p: p.drive_along - p.gravity_along,
    "in_plane_drive_y": lambda p: p.drive_across,
    "in_plane_drive": lambda p: mp.hypot(p.in_plane_drive_x, p.in_plane_drive_y),
    "normal_acceleration": lambda p: p.gravity_normal - p.drive_normal,
    "throw_number": lambda p: throw(p.drive_normal, p.gravity_normal),
    "floor_acceleration": lambda p: (
        max(ZERO, p.normal_acceleration) if p.physical else p.normal_acceleration
    ),
    "floor_force": lambda p: p.mass * p.floor_acceleration,
    "load": lambda p: p.floor_acceleration,
    "hold_margin": lambda p: p.friction_static * p.normal_acceleration - p.in_plane_drive,
    "sliding_fraction": sliding_fraction,
    "acceleration_x": lambda p: plane_acceleration(p, p.in_plane_drive_x),
    "acceleration_y": lambda p: plane_acceleration(p, p.in_plane_drive_y),
    "acceleration_z": lambda p: max(ZERO, -p.normal_acceleration) if p.physical else ZERO,
    "rotated_acceleration_x": lambda p: (
        cos(p.yaw) * p.acceleration_x + sin(p.yaw) * p.acceleration_y
    ),
    "rotated_acceleration_y": lambda p: (
        cos(p.yaw) * p.acceleration_y - sin(p.yaw) * p.acceleration_x
    ),
    "pressure_offset_x": lambda p: pressure_offset(p, p.in_plane_drive_x, p.acceleration_x),
    "pressure_offset_y": lambda p: pressure_offset(p, p.in_plane_drive_y, p.acceleration_y),
    "track_speed": lambda p: 2 * mp.pi * p.frequency * p.amplitude * cos(p.beta) * cos(p.alpha),
    "velocity_bound": lambda p: abs(p.track_speed),
    "suggested_distance": lambda p: abs(p.amplitude / 2 * cos(p.beta) * cos(p.alpha)),
}

# --- cylinder; section 7


def roll_root(p):
    if p.rolls or p.in_plane_drive == 0 or p.grip == 0:
        return ZERO if p.rolls else p.in_plane_drive
    x2, y2, q = p.in_plane_drive_x**2, p.in_plane_drive_y**2, p.grip

    def balance(z):
        return 1 - 1 / mp.sqrt(x2 / (z + q) ** 2 + y2 / (z + 3 * q) ** 2)

    return root_between(balance, ZERO, p.in_plane_drive)


def cylinder_acceleration_x(p):
    if not p.physical:
        return plane_acceleration(p, p.in_plane_drive_x)
    if p.rolls:
        return ZERO
    q = p.grip
    return p.in_plane_drive_x * (1 - q / (p.roll_root + q)) if q else p.in_plane_drive_x


def cylinder_acceleration_y(p):
    if not p.physical:
        return plane_acceleration(p, p.in_plane_drive_y)
    return 2 * p.in_plane_drive_y / 3 if p.rolls else p.in_plane_drive_y - p.side_friction


def angular_acceleration(p):
    if p.physical and not p.rolls:
        return 2 * p.side_friction / (p.diameter / 2)
    return 4 * p.drive_across / p.diameter / (1 if p.thesis else 3)


CYLINDER = PLANE | {
    "grip": lambda p: p.friction_kinetic * p.floor_acceleration,
    "roll_margin": lambda p: (
        p.friction_static * p.normal_acceleration
        - mp.hypot(p.in_plane_drive_x, p.in_plane_drive_y / 3)
    ),
    "rolls": lambda p: p.floor_acceleration > 0 and p.roll_margin >= 0,
    "roll_root": roll_root,
    "side_friction": lambda p: (
        p.grip * p.in_plane_drive_y / (p.roll_root + 3 * p.grip) if p.grip else ZERO
    ),
    "acceleration_x": cylinder_acceleration_x,
    "acceleration_y": cylinder_acceleration_y,
    "angular_acceleration": angular_acceleration,
}

# --- track; section 4.  K: starting_acceleration; limit: K R/mu, the square of the end speed


def track_wall_acceleration(p):
    if p.physical:
        return max(ZERO, p.wall_balance)
    return p.height * p.wall_balance / p.pole if p.pole else mp.nan


def track_floor_acceleration(p):
    if p.physical:
        return max(ZERO, p.normal_acceleration)
    return p.wall_acceleration * (1 - p.friction_static * p.width / p.height)


def chord_cosine(p):
    sine = p.length / (2 * p.radius)
    return mp.sqrt(1 - sine**2) if sine <= 1 else mp.nan


def corner_force(p, sign):
    share = p.length + sign * p.friction_kinetic * p.width
    return p.wall_force * share / (2 * p.length * p.chord_cosine) if p.chord_cosine else mp.nan


def track_acceleration_x(p):
    mu, D = p.friction_kinetic, p.in_plane_drive_x
    if not p.physical:
        return p.starting_acceleration - mu * p.centripetal_acceleration
    if p.speed == 0 and p.hold_margin >= 0:
        return ZERO
    return D - mu * p.load if p.speed > 0 or D > 0 else D + mu * p.load


def speed_squared(p):
    """Return v^2 at the distance; negative where the part does not get there."""
    if p.friction_kinetic == 0:
        return p.speed**2 + 2 * p.starting_acceleration * p.distance
    return p.limit + (p.speed**2 - p.limit) * mp.exp(-p.damping)


def terminal_velocity(p):
    if p.starting_acceleration <= 0:
        return ZERO
    return mp.sqrt(p.limit) if p.friction_kinetic else mp.inf


def travel_time(p):
    v0, v, x, mu = p.speed, p.transport_velocity, p.distance, p.friction_kinetic
    if x == 0 or v == 0:
        return ZERO if x == 0 else mp.inf
    if mu == 0:
        return 2 * x / (v + v0)
    if p.starting_acceleration == 0:
        return p.radius / mu * (1 / v - 1 / v0)
    end = mp.sqrt(abs(p.limit))
    if p.starting_acceleration < 0:
        return (mp.atan(v0 / end) - mp.atan(v / end)) / p.rate
    return (mp.log((end + v) / (end + v0)) + p.damping / 2) / p.rate


def stopping(p, with_friction, without):
    """Return a distance or time to the stop, infinite where it does not come."""
    if p.starting_acceleration >= 0:
        return mp.inf if p.starting_acceleration or p.speed else ZERO
    return with_friction(p) if p.friction_kinetic else without(p)


def velocity_at_time(p):
    K, v0, t, mu = p.starting_acceleration, p.speed, p.time, p.friction_kinetic
    if p.time_left <= 0 and t > 0:
        return ZERO
    if mu == 0 or K == 0:
        return (v0 + K * t) / (1 + mu * v0 * t / p.radius)
    end, u = mp.sqrt(abs(p.limit)), p.rate * t
    c, s = (mp.cosh(u), mp.sinh(u)) if K > 0 else (mp.cos(u), mp.sin(u))
    return end * (v0 * c + mp.sign(K) * end * s) / (end * c + v0 * s)


def distance_at_time(p):
    K, v0, t, mu = p.starting_acceleration, p.speed, p.time, p.friction_kinetic
    if p.time_left <= 0 and t > 0:
        return p.stopping_distance
    if mu == 0:
        return v0 * t + K * t**2 / 2
    if K == 0:
        return p.radius / mu * mp.log(1 + mu * v0 * t / p.radius)
    u, ratio = p.rate * t, v0 / mp.sqrt(abs(p.limit))
    grown = mp.cosh(u) + ratio * mp.sinh(u) if K > 0 else mp.cos(u) + ratio * mp.sin(u)
    return p.radius / mu * mp.log(grown)


def distance_bound(p):
    K, mu = p.starting_acceleration, p.friction_kinetic
    if K <= 0 or p.bound_margin <= 0:
        return mp.inf
    if mu == 0:
        return p.velocity_bound**2 / (2 * K)
    return -p.radius / (2 * mu) * mp.log(p.bound_margin / K)


TRACK = PLANE | {
    "gravity_normal": lambda p: p.gravity * cos(p.gamma) * cos(p.delta),
    "gravity_across": lambda p: p.gravity * cos(p.gamma) * sin(p.delta),
    "centripetal_acceleration": lambda p: p.speed**2 / p.radius,
    "lean": lambda p: -p.gravity_across if p.thesis else p.gravity_across,
    "starting_acceleration": lambda p: (
        p.in_plane_drive_x + p.friction_kinetic * (p.drive_across - p.lean)
    ),
    "wall_balance": lambda p: p.centripetal_acceleration + p.lean - p.drive_across,
    "wall_pull": lambda p: p.drive_across - p.lean,
    "wall_speed": lambda p: mp.sqrt(p.radius * max(ZERO, p.wall_pull)),
    "pole": lambda p: 2 * p.height - p.friction_static * p.width,
    "wall_acceleration": track_wall_acceleration,
    "floor_acceleration": track_floor_acceleration,
    "z_residual": lambda p: (
        p.floor_acceleration - p.normal_acceleration - p.friction_static * p.wall_acceleration
    ),
    "wall_force": lambda p: p.mass * p.wall_acceleration,
    "chord_cosine": chord_cosine,
    "wall_force_front": lambda p: corner_force(p, 1),
    "wall_force_rear": lambda p: corner_force(p, -1),
    "load": lambda p: p.floor_acceleration + p.wall_acceleration,
    "hold_margin": lambda p: p.friction_static * p.load - abs(p.in_plane_drive_x),
    "acceleration_x": track_acceleration_x,
    "acceleration_y": lambda p: (
        p.centripetal_acceleration + (max(ZERO, -p.wall_balance) if p.physical else ZERO)
    ),
    "limit": lambda p: p.starting_acceleration * p.radius / p.friction_kinetic,
    "rate": lambda p: mp.sqrt(p.friction_kinetic * abs(p.starting_acceleration) / p.radius),
    "damping": lambda p: 2 * p.friction_kinetic * p.distance / p.radius,
    "speed_squared": speed_squared,
    "transport_velocity": lambda p: mp.sqrt(max(ZERO, p.speed_squared)),
    "terminal_velocity": terminal_velocity,
    "travel_time": travel_time,
    "mean_velocity": lambda p: p.distance / p.travel_time if p.distance else p.speed,
    "stopping_distance": lambda p: stopping(
        p,
        lambda p: p.radius / (2 * p.friction_kinetic) * mp.log(1 - p.speed**2 / p.limit),
        lambda p: -(p.speed**2) / (2 * p.starting_acceleration),
    ),
    "stopping_time": lambda p: stopping(
        p,
        lambda p: mp.atan(p.speed / mp.sqrt(-p.limit)) / p.rate,
        lambda p: -p.speed / p.starting_acceleration,
    ),
    "time_left": lambda p: p.stopping_time - p.time,
    "velocity_at_time": velocity_at_time,
    "distance_at_time": distance_at_time,
    "bound_margin": lambda p: (
        p.starting_acceleration - p.friction_kinetic * p.velocity_bound**2 / p.radius
    ),
    "distance_bound": distance_bound,
}

FORMULAS = {"rectangle-on-plane": PLANE, "cylinder-on-plane": CYLINDER, "rectangle-on-track": TRACK}


def digits(scene, variant, given):
    """Return enough digits: no difference above cancels more than the decades of its factors."""
    names = ("friction_kinetic", "radius", "distance", "time", "speed", "starting_acceleration")
    known = FORMULAS[scene].keys() | given.keys()
    with mp.workdps(DIGITS):
        point = Point(scene, variant, given)
        factors = [getattr(point, name) for name in (*names, "velocity_bound") if name in known]
        return DIGITS + 2 * int(sum(abs(mp.log10(abs(factor))) for factor in factors if factor))
