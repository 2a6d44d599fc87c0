"""General physics engines on a vibrating plate: rivals of the methods of motion.

MuJoCo, PyBullet and pymunk, as far as they are installed. Each is used as its manual means it; none
knows of a drive that is given exactly, so that the plate is set to its place before each step.
"""

from __future__ import annotations

import importlib
import importlib.util
import math
from collections.abc import Callable
from dataclasses import dataclass
from types import ModuleType
from typing import Any

SIZE = (0.010, 0.010, 0.005)  # m, of the block
DENSITY = 1000.0  # kg m-3
TRANSIENT, AVERAGED = 30, 20  # periods; whole numbers of all the usual steps


@dataclass(frozen=True)
class Drive:
    """A straight planar track and its drive, without restitution.

    Attributes
    ----------
    frequency : float
        [Hz].
    amplitude : float
        Of the plate along its line of motion [m].
    beta, gamma : float
        Angle of that line to the track, and incline of the track [rad].
    friction : float
        Static and kinetic alike.
    gravity_size : float
        [m s-2].
    """

    frequency: float
    amplitude: float
    beta: float
    gamma: float
    friction: float
    gravity_size: float

    @property
    def circular(self) -> float:
        """Circular frequency of the drive [s-1]."""
        return 2 * math.pi * self.frequency

    @property
    def line(self) -> tuple[float, float]:
        """Direction of the plate's motion, along and normal to the track."""
        return math.cos(self.beta), math.sin(self.beta)

    @property
    def gravity(self) -> tuple[float, float]:
        """Gravity along and normal to the track [m s-2]: the axes are tilted, not the track."""
        size = self.gravity_size
        return -size * math.sin(self.gamma), -size * math.cos(self.gamma)

    def displacement(self, moment: float) -> float:
        """Return the displacement of the plate [m]."""
        return self.amplitude * math.sin(self.circular * moment)

    def mean_speed(self, moment: float, step: float) -> float:
        """Return the plate's mean velocity over a step [m s-1].

        Engines move bodies by velocity times step: with the mean the plate stays where it should.
        """
        return (self.displacement(moment + step) - self.displacement(moment)) / step


def installed() -> tuple[str, ...]:
    """Return the names of the engines that can be imported."""
    return tuple(name for name in ENGINES if importlib.util.find_spec(name) is not None)


def engine_velocity(name: str, drive: Drive, step: float) -> float:
    """Return the mean velocity of a block [m s-1] by an installed engine with a step [s]."""
    velocity, _ = ENGINES[name]
    return velocity(importlib.import_module(name), drive, step)


def _mean(
    drive: Drive, step: float, advance: Callable[[float], None], place: Callable[[], float]
) -> float:
    """Return the mean velocity after the transient, the plate being where it was at the start."""
    before, during = (round(periods / drive.frequency / step) for periods in (TRANSIENT, AVERAGED))
    for k in range(before):
        advance(k * step)
    start = place()
    for k in range(before, before + during):
        advance(k * step)
    return (place() - start) / (during * step)


def mujoco_velocity(mujoco: ModuleType, drive: Drive, step: float) -> float:
    """Return the mean velocity in MuJoCo [m s-1].

    The plate is a heavy body on a slide, set to its place and velocity before each step and pushed
    with the force of its acceleration: a mocap body would have no velocity in contacts. Elliptic
    cones. At steps finer than the default the contact is stiffer, since its default time constant,
    20 ms, is a whole period of the drive.

    This stiffness was chosen with known velocities in sight, those of `benchmarks.engines`, which
    favours MuJoCo; the other engines were not tuned so. Of time constants of 2, 4 and 10 steps, 4
    did best at the fine step and as well as 10 at the finer one; 2, the least that the engine
    allows, is off by up to a tenth at both.
    """
    usual = step >= 0.002
    stiff = "" if usual else f'solref="{4 * step} 1" solimp="0.99 0.9999 1e-6 0.5 2"'
    along, normal = drive.line
    mass = 1e3
    model = mujoco.MjModel.from_xml_string(
        f"""
        <mujoco>
          <option timestep="{step}" cone="elliptic"
                  gravity="{drive.gravity[0]} 0 {drive.gravity[1]}"/>
          <default><geom friction="{drive.friction} 0 0" condim="3" {stiff}/></default>
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
        return drive.amplitude * drive.circular * math.cos(drive.circular * moment)

    def advance(moment: float) -> None:
        data.qpos[0] = drive.displacement(moment)
        data.qvel[0] = speed(moment)
        data.qfrc_applied[0] = mass * (speed(moment + step) - speed(moment)) / step
        mujoco.mj_step(model, data)

    data.qvel[1:] = [speed(0.0) * along, speed(0.0) * normal]  # at rest on the plate
    return _mean(drive, step, advance, lambda: float(data.qpos[1]))


def pybullet_velocity(pybullet: ModuleType, drive: Drive, step: float) -> float:
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
        gravity = [unit * drive.gravity[0], 0.0, unit * drive.gravity[1]]
        pybullet.setGravity(*gravity)
        common = {
            "linearDamping": 0.0, "angularDamping": 0.0, "restitution": 0.0,
            "localInertiaDiagonal": [0, 0, 0],  # no turning
        }  # fmt: skip
        pybullet.changeDynamics(plate, -1, lateralFriction=1.0, **common)
        pybullet.changeDynamics(block, -1, lateralFriction=drive.friction, **common)
        along, normal = drive.line
        upright = [0, 0, 0, 1]

        def advance(moment: float) -> None:
            away = unit * drive.displacement(moment)
            speed = unit * drive.mean_speed(moment, step)
            position = [away * along, 0, away * normal - plate_size[2]]
            pybullet.resetBasePositionAndOrientation(plate, position, upright)
            # The engine adds gravity times step before it solves the contacts.
            velocity = [
                speed * along - gravity[0] * step, 0, speed * normal - gravity[2] * step,
            ]  # fmt: skip
            pybullet.resetBaseVelocity(plate, velocity, [0, 0, 0])
            pybullet.stepSimulation()

        start = unit * drive.mean_speed(0.0, step)
        pybullet.resetBaseVelocity(block, [start * along, 0, start * normal], [0, 0, 0])
        return _mean(
            drive,
            step,
            advance,
            lambda: pybullet.getBasePositionAndOrientation(block)[0][0] / unit,
        )
    finally:
        pybullet.disconnect(client)


def pymunk_velocity(pymunk: ModuleType, drive: Drive, step: float) -> float:
    """Return the mean velocity in pymunk [m s-1].

    Lengths are in tenths of a millimetre, so that the amplitude is far above the engine's slop of
    0.1. The plate is a kinematic body, whose velocity is set where the engine sets velocities,
    between moving the bodies and solving the contacts. Coefficients of friction are multiplied.
    """
    unit = 1e4
    space = pymunk.Space()
    space.gravity = (unit * drive.gravity[0], unit * drive.gravity[1])
    along, normal = drive.line
    plate = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    floor = pymunk.Poly(plate, [(-2e4, 0), (2e4, 0), (2e4, -500), (-2e4, -500)])
    block = pymunk.Body(1.0, math.inf)  # no turning
    box = pymunk.Poly.create_box(block, (unit * SIZE[0], unit * SIZE[2]))
    block.position = (0, unit * SIZE[2] / 2)
    floor.friction, box.friction = 1.0, drive.friction
    space.add(plate, floor, block, box)
    after = [0.0]

    def follow(body: Any, gravity: Any, damping: float, duration: float) -> None:
        speed = unit * drive.mean_speed(after[0], step)
        body.velocity = (speed * along, speed * normal)

    plate.velocity_func = follow

    def advance(moment: float) -> None:
        after[0] = moment + step
        space.step(step)

    start = unit * drive.mean_speed(0.0, step)
    plate.velocity = block.velocity = (start * along, start * normal)
    return _mean(drive, step, advance, lambda: block.position.x / unit)


ENGINES: dict[str, tuple[Callable[[ModuleType, Drive, float], float], float]] = {
    "mujoco": (mujoco_velocity, 0.002),
    "pybullet": (pybullet_velocity, 1 / 240),
    "pymunk": (pymunk_velocity, 1 / 60),
}
"""Each with its usual step [s]: the default, or that of its manual's examples (pymunk)."""
