"""How near found waves come to the fastest one, and none beyond; `python -m benchmarks.best_wave`.

Draws the best and the robust wave to docs/generated/best-wave.png. `--waves 10000` says how many
random ones of each kind are tried.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from benchmarks.options import options
from benchmarks.timing import timed
from vibrafeed.core.intake import parse_study
from vibrafeed.core.kinds import run_study
from vibrafeed.core.motion.drives import driven, shape_of
from vibrafeed.core.motion.events import planar_path
from vibrafeed.core.motion.systems import SYSTEMS
from vibrafeed.core.motion.waves import ALONG, speed
from vibrafeed.core.plan.plan import plan_scene, run_equations

Array = np.ndarray
PICTURE = Path(__file__).parents[1] / "docs" / "generated" / "best-wave.png"
GRAVITY, FREQUENCY, MOST, FRICTION, BAND = 9.81, 50.0, 30.0, 0.4, 0.1
KINDS = [(kind, count) for kind in ("steps", "harmonics") for count in (2, 3, 4, 6)]


# --- random waves


def motions(outputs: tuple[str, ...], given: Mapping[str, Array]) -> dict[str, Any]:
    """Return outputs of a part on a plane under given drives, SI units."""
    shape, _ = shape_of(given)
    assert shape is not None
    plan = plan_scene(driven(SYSTEMS["rectangle-on-plane"], shape), "events", outputs, given)
    return run_equations(plan, given)


def random_waves(
    kind: str, count: int, waves: int, random: np.random.Generator
) -> dict[str, Array]:
    """Return random waves of a number of steps or harmonics with largest acceleration 1."""
    orders = range(1, count + 1)
    if kind == "steps":
        given = {f"acceleration_along_{n}": random.uniform(-1, 1, waves) for n in orders[:-1]}
        given |= {f"duration_{n}": random.exponential(size=waves) for n in orders}
    else:
        given = {f"amplitude_along_{n}": random.exponential(size=waves) / n**2 for n in orders}
        given |= {f"phase_along_{n}": random.uniform(0, 2 * np.pi, waves) for n in orders}
        given |= {"frequency": np.full(waves, 1 / (2 * np.pi))}
    output = "largest_acceleration_along"
    largest = motions((output,), {**given, "gravity": np.ones(waves)})[output]
    return {**given, "drive_factor": 1 / largest}


def shares(kind: str, count: int, waves: int, random: np.random.Generator) -> Array:
    """Return the share of the fastest velocity that random waves reach, level and climbing.

    On a level track the larger of both ways; 0 where no wave frees the part and none did.
    """
    given = random_waves(kind, count, waves, random)
    kinetic = random.uniform(0.05, 0.6, waves)
    static = kinetic * np.where(random.random(waves) < 0.5, 1.0, random.uniform(1, 1.6, waves))
    gamma = np.where(random.random(waves) < 0.6, 0.0, random.uniform(0, 0.3, waves))
    frequency = random.uniform(10, 100, waves)
    most = static * GRAVITY * np.exp(random.uniform(-0.1, 2.5, waves))
    unit = np.square(2 * np.pi * frequency) if kind == "harmonics" else 1.0
    given |= {
        "drive_factor": given["drive_factor"] * most / unit,
        "frequency": frequency,
        "gravity": np.full(waves, GRAVITY),
        "friction_static": static,
        "friction_kinetic": kinetic,
        "gamma": gamma,
    }
    found = motions(("conveying_velocity", "fastest_velocity"), given)
    velocity, fastest = found["conveying_velocity"], found["fastest_velocity"]
    known = np.isfinite(velocity) & np.isfinite(fastest)
    velocity = np.where(gamma == 0, np.abs(velocity), velocity)[known]
    fastest = fastest[known]
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(velocity > 0, velocity / fastest, 0.0)


# --- searched waves


def study(**changes: Any) -> dict[str, Any]:
    """Return a study that seeks the best wave in steps on a level track."""
    return {
        "kind": "optimise",
        "scene": "rectangle-on-plane",
        "outputs": ["share_of_fastest", "fastest_velocity"],
        "criterion": {"kind": "maximise", "output": "conveying_velocity"},
        "constraints": [{"output": "largest_acceleration_along", "upper": MOST}],
        "parameters": {"frequency": FREQUENCY, "gravity": GRAVITY, "friction": FRICTION},
        **changes,
    }


def steps(count: int) -> dict[str, Any]:
    """Return variables of a wave in steps; its last level and first duration are determined."""
    levels = {f"acceleration_along_{n}": _range(-MOST, MOST) for n in range(1, count)}
    return levels | {f"duration_{n}": _range(0, 4) for n in range(2, count + 1)}


def harmonics(count: int) -> dict[str, Any]:
    """Return variables of a wave of harmonics, without a shift of time."""
    unit = MOST / (2 * np.pi * FREQUENCY) ** 2
    sizes = {f"amplitude_along_{n}": _range(0, 2 * unit / n**2) for n in range(1, count + 1)}
    return sizes | {f"phase_along_{n}": _range(-180, 180) for n in range(2, count + 1)}


def _range(lower: float, upper: float) -> dict[str, float]:
    """Return a range of a variable."""
    return {"lower": lower, "upper": upper}


def best(content: Mapping[str, Any]) -> Any:
    """Return the dataset of an optimisation."""
    return run_study(parse_study(dict(content)))


def wave_of(found: Any) -> dict[str, float]:
    """Return the best wave of a result in three steps, starting with its longest step."""
    levels = [float(found[f"best_acceleration_along_{n}"]) for n in (1, 2)]
    last = [1.0, *(float(found[f"best_duration_{n}"]) for n in (2, 3))]
    levels.append(-(levels[0] * last[0] + levels[1] * last[1]) / last[2])
    turn = last.index(max(last))
    levels, last = levels[turn:] + levels[:turn], last[turn:] + last[:turn]
    return {f"acceleration_along_{n}": level for n, level in enumerate(levels[:2], 1)} | {
        f"duration_{n}": one for n, one in enumerate(last, 1)
    }


def known_best(static: float, kinetic: float) -> dict[str, float]:
    """Return the fastest known wave on a level track."""
    return fastest_wave(static * GRAVITY, kinetic * GRAVITY, MOST)


def fastest_wave(holding: float, braking: float, most: float) -> dict[str, float]:
    """Return the fastest wave (carry, away, catch), a rounding on the safe side of the limit.

    It carries the part for 1e-9 longer, less a tenth of that in strength, so that the part is
    caught just after the track has turned: just before, it would not be if it sticks more than it
    slides.
    """
    carry = braking / (holding + braking) * (1 + 1e-9)
    held = holding * (1 - 1e-10)
    away = ((1 - carry) + held * carry / most) / 2
    return {
        "acceleration_along_1": held, "acceleration_along_2": -most,
        "duration_1": carry, "duration_2": away, "duration_3": 1 - carry - away,
    }  # fmt: skip


# --- the program


def _random(waves: int) -> None:
    """Print the largest share of the fastest velocity among random waves."""
    print(f"{waves:,} random waves each: the largest share of the fastest velocity")
    random = np.random.default_rng(1)
    for kind, count in KINDS:
        largest = float(shares(kind, count, waves, random).max())
        print(f"  {count} {kind}: {largest:.6f}", flush=True)


def _searched() -> None:
    """Print the share of the fastest velocity that searches find, and their time."""
    print("searched waves: share of the fastest velocity, seconds")
    best(study(variables=steps(2)))  # compiled code is loaded
    for name, variables in (
        *((f"{n} steps", steps(n)) for n in (2, 3, 4, 5)),
        *((f"{n} harmonics", harmonics(n)) for n in (2, 3, 4)),
    ):
        found, seconds = timed(best, study(variables=variables))
        share = float(found["share_of_fastest"])
        print(f"  {name}: {share:.8f}, {seconds:.1f} s", flush=True)


class Case(NamedTuple):
    """A band of friction, the fastest and the robust wave in it, the best worst case of four steps.

    `bound` is the least of the fastest velocities over the band: no worst case is above it.
    """

    title: str
    frictions: Array
    given: Callable[[Array], dict[str, Array]]
    waves: dict[str, dict[str, float]]
    four: float
    bound: float


def cases() -> list[Case]:
    """Return test cases: both coefficients vary in a band, or the static one alone."""
    found = []
    for static, name in ((FRICTION, "friction"), (1.25 * FRICTION, "friction_static")):
        ends = static * (1 - BAND), static * (1 + BAND)
        more = {} if name == "friction" else {"friction_kinetic": FRICTION}
        fixed = {"frequency": FREQUENCY, "gravity": GRAVITY, **more}
        band = {"robust": "worst", "uncertain": {name: _range(*ends)}, "parameters": fixed}
        three, four = (best(study(variables=steps(n), outputs=[], **band)) for n in (3, 4))
        waves = {"fastest": known_best(static, FRICTION), "robust": wave_of(three)}

        def given(friction: Array, name: str = name, more: Any = more) -> dict[str, Array]:
            """Return the parameters of friction values, with the other ones constant."""
            same = {other: np.full_like(friction, value) for other, value in more.items()}
            return {name: friction, **same}

        title = f"{name.replace('_', ' ')} {static:g} +- {BAND:.0%}"
        title += f", kinetic {FRICTION:g}" if more else ""
        frictions = np.linspace(*ends, 2001)
        drive = {"frequency": FREQUENCY, "gravity": GRAVITY, **waves["fastest"]}
        numbers = {n: np.full_like(frictions, value) for n, value in drive.items()}
        fastest = motions(("fastest_velocity",), numbers | given(frictions))["fastest_velocity"]
        bound = float(fastest.min()) * 1e3
        found.append(Case(title, frictions, given, waves, float(four.objective) * 1e3, bound))
    return found


def over_band(wave: Mapping[str, float], friction: Mapping[str, Array]) -> Array:
    """Return the velocity of one wave at many values of friction [mm/s]."""
    shape = next(iter(friction.values())).shape
    given = {**wave, "frequency": FREQUENCY, "gravity": GRAVITY}
    given = {name: np.full(shape, value) for name, value in given.items()}
    found = motions(("conveying_velocity",), {**given, **friction})
    return np.asarray(found["conveying_velocity"] * 1e3)


def draw(rows: list[Case]) -> None:
    """Draw the velocities of track and part over a period, for each band of friction."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 8.0), layout="constrained")
    panels = figure.subplots(len(rows), 2, sharex=True, sharey=True)
    phases = np.linspace(0.0, 2 * np.pi, 2001)
    time = phases / (2 * np.pi * FREQUENCY) * 1e3
    for row, case in zip(panels, rows, strict=True):
        for panel, (name, wave) in zip(row, case.waves.items(), strict=True):
            for at, look in ((0, "C0"), (1000, "k"), (2000, "C1")):
                friction = case.given(case.frictions[at : at + 1])
                track, part, mean = course({**wave, **friction}, phases)
                label = f"part at {case.frictions[at]:g}: mean {mean:.2f} mm/s"
                panel.plot(time, part, color=look, label=label, linewidth=1.3)
            panel.plot(time, track, color="#8a6a3a", label="track", linewidth=0.9)
            panel.set(title=f"{name} wave, {case.title}")
            panel.title.set_fontsize(9)
            panel.axhline(0.0, color="0.7", linewidth=0.6, zorder=0)
            panel.legend(fontsize=8, frameon=False, loc="lower left")
        row[0].set_ylabel("velocity [mm/s]")
    for panel in panels[-1]:
        panel.set_xlabel("time in the period [ms]")
    figure.savefig(PICTURE, dpi=110)


def course(drive: Mapping[str, float], phases: Array) -> tuple[Array, Array, float]:
    """Return the velocities of track and part at phases, and the part's mean [mm/s]."""
    given = {**drive, "frequency": FREQUENCY, "gravity": GRAVITY}
    given = {name: np.asarray(value).reshape(()) for name, value in given.items()}
    known = motions(("conveying_velocity",), given)
    settings = {name: known[name].item() for name in ("tolerance", "max_periods")}
    path, _ = planar_path(known["groups"].single(), **settings, phases=phases)
    scale = known["velocity_scale"] * 1e3
    track = speed(known["wave"], ALONG, phases) * scale
    return track, track + path.velocity[:, 0] * scale, float(known["conveying_velocity"]) * 1e3


def main() -> None:
    """Print all figures and draw the picture."""
    _random(options(__doc__, waves=10_000).waves)
    _searched()
    rows = cases()
    for case in rows:
        print(f"{case.title}: velocity [mm/s] in the worst case, in the middle")
        for name, wave in case.waves.items():
            velocity = over_band(wave, case.given(case.frictions))
            print(f"  {name}: {velocity.min():.3f}, {velocity[velocity.size // 2]:.3f}")
        print(f"  robust, four steps: {case.four:.3f}; none above {case.bound:.3f}")
    draw(rows)


if __name__ == "__main__":
    main()
