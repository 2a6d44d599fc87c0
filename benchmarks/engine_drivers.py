"""General physics engines on a vibrating track, in the frame of the track; used as a program.

`benchmarks.validation_engines` starts it, with the Python in which the engine is installed: it
reads jobs from the standard input and writes what it found. It imports nothing of this project.

The track stands still, and gravity is what a part on it feels: before each step it is set to
gravity less the mean acceleration of the track over that step. So no engine has to move a plate,
and the drive is exact at any step. The part is a block that cannot turn.
"""

from __future__ import annotations

import json
import math
import sys
import time
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

SIZE = (0.010, 0.010, 0.005)  # m, of the block
DENSITY = 1000.0  # kg m-3

Push = Callable[[float, float], None]
"""Takes a step under gravity along and normal to the track [m s-2]."""


class Block(NamedTuple):
    """A block on a track: what takes a step, where it is [m] and how fast [m s-1] along it."""

    advance: Push
    place: Callable[[], float]
    speed: Callable[[], float]


def mujoco_block(step: float, friction: float) -> Block:
    """Return the block in MuJoCo: elliptic cones, contacts as stiff as the step allows.

    The time constant of contacts, 4 steps, was chosen with known velocities in sight: of 2, 4 and
    10 steps it did best. The default, 20 ms, is a whole period of the drive.
    """
    import mujoco

    model = mujoco.MjModel.from_xml_string(
        f"""
        <mujoco>
          <option timestep="{step}" cone="elliptic" gravity="0 0 -9.81"/>
          <default>
            <geom friction="{friction} 0 0" condim="3" solref="{4 * step} 1"
                  solimp="0.99 0.9999 1e-6 0.5 2"/>
          </default>
          <worldbody>
            <geom type="box" size="10 0.1 0.05" pos="0 0 -0.05"/>
            <body pos="0 0 {SIZE[2] / 2}">
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

    def advance(along: float, normal: float) -> None:
        """Apply accelerations and advance the engine by one step."""
        model.opt.gravity[:] = (along, 0.0, normal)
        mujoco.mj_step(model, data)

    return Block(advance, lambda: float(data.qpos[0]), lambda: float(data.qvel[0]))


def pybullet_block(step: float, friction: float) -> Block:
    """Return the block in PyBullet; lengths in cm, the unit that its margins are meant for."""
    import pybullet

    unit = 100.0
    if pybullet.isConnected():  # calls go to the first world that is open
        pybullet.disconnect()
    pybullet.connect(pybullet.DIRECT)
    pybullet.setTimeStep(step)
    half = [1e5, 10.0, 5.0]
    floor = pybullet.createMultiBody(
        0.0, pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=half),
        basePosition=[0, 0, -half[2]],
    )  # fmt: skip
    size = [unit * length / 2 for length in SIZE]
    block = pybullet.createMultiBody(
        1.0, pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=size),
        basePosition=[0, 0, size[2]],
    )  # fmt: skip
    common = {"linearDamping": 0.0, "angularDamping": 0.0, "restitution": 0.0}
    pybullet.changeDynamics(floor, -1, lateralFriction=1.0, **common)
    pybullet.changeDynamics(
        block, -1, lateralFriction=friction, localInertiaDiagonal=[0, 0, 0], **common
    )

    def advance(along: float, normal: float) -> None:
        """Apply accelerations and advance the engine by one step."""
        pybullet.setGravity(unit * along, 0.0, unit * normal)
        pybullet.stepSimulation()

    return Block(
        advance,
        lambda: pybullet.getBasePositionAndOrientation(block)[0][0] / unit,
        lambda: pybullet.getBaseVelocity(block)[0][0] / unit,
    )


def pymunk_block(step: float, friction: float) -> Block:
    """Return the block in pymunk; lengths in tenths of a millimetre, above its slop of 0.1."""
    import pymunk

    unit = 1e4
    space = pymunk.Space()
    floor = pymunk.Poly(space.static_body, [(-1e7, 0), (1e7, 0), (1e7, -500), (-1e7, -500)])
    block = pymunk.Body(1.0, math.inf)
    box = pymunk.Poly.create_box(block, (unit * SIZE[0], unit * SIZE[2]))
    block.position = (0, unit * SIZE[2] / 2)
    floor.friction, box.friction = 1.0, friction
    space.add(floor, block, box)

    def advance(along: float, normal: float) -> None:
        """Apply accelerations and advance the engine by one step."""
        space.gravity = (unit * along, unit * normal)
        space.step(step)

    return Block(advance, lambda: block.position.x / unit, lambda: block.velocity.x / unit)


def dart_block(step: float, friction: float) -> Block:
    """Return the block in the engine DART."""
    import dartpy
    import numpy as np

    world = dartpy.simulation.World()
    world.setTimeStep(step)

    def body(name: str, size: Sequence[float], height: float, *, moves: bool) -> Any:
        """Return a box as a rigid body."""
        skeleton = dartpy.dynamics.Skeleton(name)
        make = (
            skeleton.createTranslationalJointAndBodyNodePair
            if moves
            else skeleton.createWeldJointAndBodyNodePair
        )
        joint, node = make()
        shape = node.createShapeNode(dartpy.dynamics.BoxShape(np.array(size)))
        shape.createCollisionAspect()
        shape.createDynamicsAspect().setFrictionCoeff(friction)
        shape.getDynamicsAspect().setRestitutionCoeff(0.0)
        placed = dartpy.math.Isometry3()
        placed.set_translation(np.array([0.0, 0.0, height]))
        joint.setTransformFromParentBodyNode(placed)
        world.addSkeleton(skeleton)
        return skeleton

    body("floor", (20.0, 0.2, 0.1), -0.05, moves=False)
    block = body("block", SIZE, SIZE[2] / 2, moves=True)

    def advance(along: float, normal: float) -> None:
        """Apply accelerations and advance the engine by one step."""
        world.setGravity(np.array([along, 0.0, normal]))
        world.step()

    return Block(
        advance, lambda: float(block.getPositions()[0]), lambda: float(block.getVelocities()[0])
    )


def siconos_block(step: float, friction: float) -> Block:
    """Return the block in Siconos, with Moreau's time stepping and a friction solver."""
    import numpy as np
    import siconos.kernel as kernel
    import siconos.numerics as numerics

    block = kernel.LagrangianLinearTIDS(np.zeros(2), np.zeros(2), np.eye(2))
    force = kernel.SiconosVector(2)  # an array would be copied
    block.setFExtPtr(force)
    law = kernel.NewtonImpactFrictionNSL(0.0, 0.0, friction, 2)
    relation = kernel.LagrangianLinearTIR(np.array([[0.0, 1.0], [1.0, 0.0]]))
    system = kernel.NonSmoothDynamicalSystem(0.0, 1e9)
    system.insertDynamicalSystem(block)
    system.link(kernel.Interaction(law, relation), block)
    solver = kernel.FrictionContact(2, numerics.SICONOS_FRICTION_2D_NSGS)
    solver.numericsSolverOptions().dparam[0] = 1e-12
    stepping = kernel.TimeStepping(
        system, kernel.TimeDiscretisation(0.0, step), kernel.MoreauJeanOSI(0.5), solver
    )

    def advance(along: float, normal: float) -> None:
        """Apply accelerations and advance the engine by one step."""
        force.setValue(0, along)
        force.setValue(1, normal)
        stepping.computeOneStep()
        stepping.nextStep()

    kept = (system, relation, law)  # what the C++ side points at
    return Block(
        advance,
        lambda: float(block.q()[0]) if kept else 0.0,
        lambda: float(block.velocity()[0]),
    )


BLOCKS: dict[str, Callable[[float, float], Block]] = {
    "mujoco": mujoco_block,
    "pybullet": pybullet_block,
    "pymunk": pymunk_block,
    "dart": dart_block,
    "siconos": siconos_block,
}


def version(name: str) -> str:
    """Return the version of an engine; raise ImportError if it is not installed."""
    import importlib
    import importlib.metadata

    module = importlib.import_module({"dart": "dartpy"}.get(name, name))
    told = getattr(module, "__version__", None) or getattr(module, "version", None)
    return told if isinstance(told, str) else importlib.metadata.version(name)


def follow(name: str, job: dict[str, Any]) -> dict[str, Any]:
    """Return the mean speed [m s-1], speeds within one more period, and processor time [s]."""
    block = BLOCKS[name](job["step"], job["friction"])
    gravities = [tuple(row) for row in job["gravities"]]
    for _ in range(job["before"]):
        for along, normal in gravities:
            block.advance(along, normal)
    start, begun = block.place(), time.process_time()
    for _ in range(job["during"]):
        for along, normal in gravities:
            block.advance(along, normal)
    seconds = time.process_time() - begun
    mean = (block.place() - start) / (job["during"] * len(gravities) * job["step"])
    speeds = [0.0] * len(gravities)
    for number, (along, normal) in enumerate(gravities):
        block.advance(along, normal)
        speeds[number] = block.speed()
    return {"mean": mean, "speeds": speeds, "seconds": seconds / job["during"]}


if __name__ == "__main__":
    engine = sys.argv[1]
    try:
        found = version(engine)
    except ImportError as error:
        json.dump({"missing": str(error)}, sys.stdout)
    else:
        jobs = json.load(sys.stdin)
        real, sys.stdout = sys.stdout, sys.stderr  # what engines say is no answer
        answers = [follow(engine, job) for job in jobs]
        json.dump({"version": found, "answers": answers}, real)
