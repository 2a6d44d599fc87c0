"""Prints mean velocities of general physics engines beside known ones: a block on a vibrating
plate in MuJoCo, PyBullet and pymunk, as far as they are installed: `python -m benchmarks.engines`.
"""  # noqa: D205

from __future__ import annotations

import importlib
import importlib.metadata
import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from types import ModuleType

GRAVITY = 9.81  # m s-2
SIZE = (0.010, 0.010, 0.005)  # m, of the block
DENSITY = 1000.0  # kg m-3
TRANSIENT, AVERAGED = 30, 20  # periods; whole numbers of all the usual steps
FINE, FINER = 1e-4, 1e-5  # s: 200 and 2,000 steps a period


@dataclass(frozen=True)
class Case:
    """A straight planar track, angles in degrees, without restitution.

    Attributes
    ----------
    name : str
    throw_number : float
        Largest acceleration of the plate normal to itself, over that of gravity.
    gamma : float
        Incline of the track.
    velocity : float
        Known mean velocity [m s-1]: of the closed forms and of a method of events.
    """

    name: str
    throw_number: float
    gamma: float
    velocity: float
    frequency: float = 50.0
    beta: float = 30.0
    friction: float = 0.5

    @property
    def circular(self) -> float:
        """Circular frequency of the drive [s-1]."""
        return 2 * math.pi * self.frequency

    @property
    def amplitude(self) -> float:
        """Amplitude of the plate along its line of motion [m]."""
        weight = GRAVITY * math.cos(math.radians(self.gamma))
        return self.throw_number * weight / math.sin(math.radians(self.beta)) / self.circular**2

    @property
    def line(self) -> tuple[float, float]:
        """Direction of the plate's motion, along and normal to the track."""
        return math.cos(math.radians(self.beta)), math.sin(math.radians(self.beta))

    @property
    def gravity(self) -> tuple[float, float]:
        """Gravity along and normal to the track [m s-2]: the axes are tilted, not the track."""
        gamma = math.radians(self.gamma)
        return -GRAVITY * math.sin(gamma), -GRAVITY * math.cos(gamma)

    def displacement(self, moment: float) -> float:
        """Return the displacement of the plate [m]."""
        return self.amplitude * math.sin(self.circular * moment)

    def mean_speed(self, moment: float, step: float) -> float:
        """Return the plate's mean velocity over a step [m s-1].

        Engines move bodies by velocity times step: with the mean the plate stays where it should.
        """
        return (self.displacement(moment + step) - self.displacement(moment)) / step


CASES = (
    Case("hop", throw_number=1.2, gamma=0.0, velocity=37.676497e-3),
    Case("stick-slip", throw_number=0.8, gamma=3.0, velocity=16.697054e-3),
)


@dataclass(frozen=True)
class Row:
    """One line of the table; the time is that of one configuration."""

    engine: str
    version: str
    case: Case
    step: str
    seconds: float
    velocity: float  # m s-1


def _mean(case: Case, step: float, advance: Callable[[float], None], place: Callable[[], float]):
    """Return the mean velocity after the transient, the plate being where it was at the start."""
    before, during = (round(periods / case.frequency / step) for periods in (TRANSIENT, AVERAGED))
    for k in range(before):
        advance(k * step)
    start = place()
    for k in range(before, before + during):
        advance(k * step)
    return (place() - start) / (during * step)


def mujoco_velocity(mujoco: ModuleType, case: Case, step: float) -> float:
    """Return the mean velocity in MuJoCo [m s-1].

    The plate is a heavy body on a slide, set to its place and velocity before each step and pushed
    with the force of its acceleration: a mocap body would have no velocity in contacts. Elliptic
    cones. At steps finer than the default the contact is stiffer, since its default time constant,
    20 ms, is a whole period of the drive.

    This stiffness was chosen with the known velocities of `CASES` in sight, which favours MuJoCo;
    the other engines were not tuned so. Of time constants of 2, 4 and 10 steps, 4 did best at the
    fine step and as well as 10 at the finer one; 2, the least that the engine allows, is off by
    up to a tenth at both.
    """
    usual = step >= 0.002
    stiff = "" if usual else f'solref="{4 * step} 1" solimp="0.99 0.9999 1e-6 0.5 2"'
    along, normal = case.line
    mass = 1e3
    model = mujoco.MjModel.from_xml_string(
        f"""
        <mujoco>
          <option timestep="{step}" cone="elliptic"
                  gravity="{case.gravity[0]} 0 {case.gravity[1]}"/>
          <default><geom friction="{case.friction} 0 0" condim="3" {stiff}/></default>
          <worldbody>
            <body name="plate" gravcomp="1">
              <joint name="drive" type="slide" axis="{along} 0 {normal}"/>
              <geom type="box" size="1 0.1 0.05" pos="0 0 -0.05" mass="{mass}"/>
            </body>
            <body name="block" pos="0 0 {SIZE[2] / 2}">
              <joint type="slide" axis="1 0 0"/>
              <joint type="slide" axis="0 0 1"/>
              <geom type="box" size="{SIZE[0] / 2} {SIZE[1] / 2} {SIZE[2] / 2}"
                    density="{DENSITY}"/>
            </body>
          </worldbody>
        </mujoco>
        """
    )
    data = mujoco.MjData(model)

    def speed(moment: float) -> float:
        return case.amplitude * case.circular * math.cos(case.circular * moment)

    def advance(moment: float) -> None:
        data.qpos[0] = case.displacement(moment)
        data.qvel[0] = speed(moment)
        data.qfrc_applied[0] = mass * (speed(moment + step) - speed(moment)) / step
        mujoco.mj_step(model, data)

    data.qvel[1:] = [speed(0.0) * along, speed(0.0) * normal]  # at rest on the plate
    return _mean(case, step, advance, lambda: float(data.qpos[1]))


def pybullet_velocity(pybullet: ModuleType, case: Case, step: float) -> float:
    """Return the mean velocity in PyBullet [m s-1].

    Lengths are in cm, so that the block is of the size of the unit for which margins and slop of
    the engine are meant. The plate is a heavy body, set to its place and velocity before each
    step: a static one would have no velocity in contacts. Coefficients of friction are multiplied.
    """
    unit = 100.0
    client = pybullet.connect(pybullet.DIRECT)
    try:
        pybullet.setTimeStep(step)
        size = [unit * length / 2 for length in SIZE]
        plate_size = [100.0, 10.0, 5.0]
        mass = 1e6
        plate = pybullet.createMultiBody(
            mass, pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=plate_size)
        )
        block = pybullet.createMultiBody(
            1.0,
            pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=size),
            basePosition=[0, 0, size[2]],
        )
        gravity = [unit * case.gravity[0], 0.0, unit * case.gravity[1]]
        pybullet.setGravity(*gravity)
        common = {
            "linearDamping": 0.0, "angularDamping": 0.0, "restitution": 0.0,
            "localInertiaDiagonal": [0, 0, 0],  # no turning
        }  # fmt: skip
        pybullet.changeDynamics(plate, -1, lateralFriction=1.0, **common)
        pybullet.changeDynamics(block, -1, lateralFriction=case.friction, **common)
        along, normal = case.line
        upright = [0, 0, 0, 1]

        def advance(moment: float) -> None:
            away = unit * case.displacement(moment)
            speed = unit * case.mean_speed(moment, step)
            position = [away * along, 0, away * normal - plate_size[2]]
            pybullet.resetBasePositionAndOrientation(plate, position, upright)
            # The engine adds gravity times step before it solves the contacts.
            velocity = [
                speed * along - gravity[0] * step, 0, speed * normal - gravity[2] * step,
            ]  # fmt: skip
            pybullet.resetBaseVelocity(plate, velocity, [0, 0, 0])
            pybullet.stepSimulation()

        start = unit * case.mean_speed(0.0, step)
        pybullet.resetBaseVelocity(block, [start * along, 0, start * normal], [0, 0, 0])
        return _mean(
            case,
            step,
            advance,
            lambda: pybullet.getBasePositionAndOrientation(block)[0][0] / unit,
        )
    finally:
        pybullet.disconnect(client)


def pymunk_velocity(pymunk: ModuleType, case: Case, step: float) -> float:
    """Return the mean velocity in pymunk [m s-1].

    Lengths are in tenths of a millimetre, so that the amplitude is far above the engine's slop of
    0.1. The plate is a kinematic body, whose velocity is set where the engine sets velocities,
    between moving the bodies and solving the contacts. Coefficients of friction are multiplied.
    """
    unit = 1e4
    space = pymunk.Space()
    space.gravity = (unit * case.gravity[0], unit * case.gravity[1])
    along, normal = case.line
    plate = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    floor = pymunk.Poly(plate, [(-2e4, 0), (2e4, 0), (2e4, -500), (-2e4, -500)])
    block = pymunk.Body(1.0, math.inf)  # no turning
    box = pymunk.Poly.create_box(block, (unit * SIZE[0], unit * SIZE[2]))
    block.position = (0, unit * SIZE[2] / 2)
    floor.friction, box.friction = 1.0, case.friction
    space.add(plate, floor, block, box)
    after = [0.0]

    def drive(body, gravity, damping, duration) -> None:
        speed = unit * case.mean_speed(after[0], step)
        body.velocity = (speed * along, speed * normal)

    plate.velocity_func = drive

    def advance(moment: float) -> None:
        after[0] = moment + step
        space.step(step)

    start = unit * case.mean_speed(0.0, step)
    plate.velocity = block.velocity = (start * along, start * normal)
    return _mean(case, step, advance, lambda: block.position.x / unit)


ENGINES = {
    # Each with its usual step: the default, or that of its manual's examples (pymunk).
    "mujoco": (mujoco_velocity, 0.002),
    "pybullet": (pybullet_velocity, 1 / 240),
    "pymunk": (pymunk_velocity, 1 / 60),
}


def engine_rows(name: str) -> list[Row]:
    """Return the lines of one engine; none where it is not installed, which is printed."""
    velocity, usual = ENGINES[name]
    try:
        engine = importlib.import_module(name)
    except ImportError:
        print(f"{name} is not installed: pip install {name}")
        return []
    version = importlib.metadata.version(name)
    rows = []
    for case in CASES:
        for step in (usual, FINE, FINER):
            start = time.perf_counter()
            found = velocity(engine, case, step)
            seconds = time.perf_counter() - start
            rows.append(Row(name, version, case, f"{step:.2g} s", seconds, found))
    return rows


def ours() -> list[Row]:
    """Return the lines of this project's methods."""
    from benchmarks.lockstep import lockstep_velocities
    from core import __version__
    from core.motion.planar import planar_motion
    from core.motion.regularised import regularised_motion

    def by_events(groups: dict[str, float]) -> float:
        return float(planar_motion(**groups, tolerance=1e-12, most_periods=1000).velocity)

    def by_steps(groups: dict[str, float]) -> float:
        names = ("drive_number_along", "drive_number_normal", "gravity_number_along",
                 "gravity_number_normal", "friction_kinetic", "restitution")  # fmt: skip
        return float(lockstep_velocities(*(groups[name] for name in names)))

    def by_regularising(groups: dict[str, float]) -> float:
        motion = regularised_motion(
            **groups, drive_number_across=0.0, gravity_number_across=0.0, slip_speed=1e-6,
            contact_stiffness=1e10, tolerance=1e-7, most_periods=100, solver="Radau", planar=True,
        )  # fmt: skip
        return float(motion.velocity)

    rows = []
    for case in CASES:
        drive = case.amplitude * case.circular**2 / GRAVITY
        groups = {
            "drive_number_along": drive * case.line[0],
            "drive_number_normal": drive * case.line[1],
            "gravity_number_along": -case.gravity[0] / GRAVITY,
            "gravity_number_normal": -case.gravity[1] / GRAVITY,
            "friction_kinetic": case.friction,
            "friction_static": case.friction,
            "restitution": 0.0,
        }
        for name, step, velocity in (
            ("events", "events", by_events),
            ("lockstep", f"{1 / case.frequency / 1600:.2g} s", by_steps),
            ("regularised", "adaptive", by_regularising),
        ):
            velocity(groups)  # compiles
            start = time.perf_counter()
            found = velocity(groups)
            seconds = time.perf_counter() - start
            scale = GRAVITY / case.circular
            rows.append(Row(name, __version__, case, step, seconds, found * scale))
    return rows


def main() -> None:
    """Print the table."""
    rows = [row for name in ENGINES for row in engine_rows(name)] + ours()
    print(
        f"{'engine':12} {'version':>8}  {'case':10} {'step':>9} {'time':>9} {'velocity':>12} "
        f"{'known':>10}  error"
    )
    for row in sorted(rows, key=lambda row: row.case.name):
        known = row.case.velocity
        print(
            f"{row.engine:12} {row.version:>8}  {row.case.name:10} {row.step:>9} "
            f"{1e3 * row.seconds:7.2f} ms {1e3 * row.velocity:7.3f} mm/s {1e3 * known:10.6f}  "
            f"{100 * (row.velocity / known - 1):+9.4f} %"
        )


if __name__ == "__main__":
    main()
