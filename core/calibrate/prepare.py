"""From a study of calibration to what can be carried out: plan, unknowns, runs, likelihood."""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import replace

import numpy as np

from vibrafeed.core.calibrate.boxes import Likelihood, Scatter
from vibrafeed.core.calibrate.calibration import MAX_CANDIDATES, Calibration
from vibrafeed.core.calibrate.model import AMPLITUDE, SEEN, SPEEDS, Model, Runs, Unknown
from vibrafeed.core.errors import Problem, StudyError, given_twice, raise_any, refused
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.drive_units import unit_of
from vibrafeed.core.motion.plate import PLATE
from vibrafeed.core.motion.prepare import choose_system, problems_of_settings
from vibrafeed.core.motion.systems import CONTACTS
from vibrafeed.core.plan.grid import Grid
from vibrafeed.core.plan.plan import choose_scene, plan_scene
from vibrafeed.core.plan.prepared import Chosen, broken_constraints, locate_problem
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.scenes import SCENES, Scene
from vibrafeed.core.scenes.scene import STATIC_ABOVE_KINETIC
from vibrafeed.core.study.calibrate_study import (
    STEMS,
    CalibrateStudy,
    parameters_of,
    read_error,
)
from vibrafeed.core.study.grid_study import OBSERVED
from vibrafeed.core.study.shown import ShownUnits
from vibrafeed.core.study.units import UnitError
from vibrafeed.core.study.values import Fixed, Points, Span, Values

MAX_UNKNOWNS = 4  # a grid over more would be too coarse to trust


def prepare(study: CalibrateStudy) -> Calibration:
    """Check a calibration study and return it ready to be computed.

    That chooses the plan of the simulated motion, and gathers the observed runs, the unknowns with
    their priors, the scatter of measurements and the candidates for the next run.
    """
    problems = [*_problems_of_fields(study), *_problems_of_unknowns(study)]
    columns = _columns(study, problems)
    output, output_problems = _observed_output(study)
    error, error_problems = _errors(study, output)
    problems += [*output_problems, *error_problems]
    values = {name: value for name, value in study.values().items() if isinstance(value, Fixed)}
    shared = {name: value.value for name, value in values.items()}
    unknowns = _unknowns(study)
    problems += _problems_of_places(unknowns, shared, columns)
    ranges = _parameter_ranges(unknowns, shared, columns, problems)
    candidate_values = study.asked_next()
    problems += _problems_of_candidates(candidate_values, shared, columns)
    # What is wrong with values above is no reason to blame the names of a plan.
    given = {**dict.fromkeys(shared), **dict.fromkeys(columns), **dict.fromkeys(ranges)}
    try:
        scene, method, name_problems = choose(study.scene, study.method, given)
        problems += [*name_problems, *_problems_of_scene(study, scene, method, output)]
        speed = output if output in SPEEDS else "conveying_velocity"
        wanted = [*dict.fromkeys((output, speed)), *SPEEDS[speed], *SEEN]
        if output == AMPLITUDE or scene.name in UNITS:
            wanted = [AMPLITUDE]
        elif scene.name in CONTACTS and speed not in scene.outputs(method):
            fix = "Measure velocity_towards on a plate, conveying_velocity or feed_rate on a track"
            raise refused("observations", f"{scene.name} has no {output}", fix)
        plan = plan_scene(scene, method, wanted, tuple(given), {*shared, *columns})
    except StudyError as error_:
        raise StudyError(
            [*problems, *(locate_problem(problem, study) for problem in error_.problems)]
        ) from None
    grid = Grid.of({**values, **ranges})
    broken = broken_constraints(_without_order_of_frictions(scene, ranges), method, grid)
    problems += (locate_problem(problem, study) for problem in broken)
    problems += _problem_of_few_runs(study, unknowns)
    raise_any(problems)
    plan = replace(plan, defaults={**plan.defaults, **study.settings()})
    runs = Runs(
        columns,
        output,
        np.array([np.nan if (value := getattr(run, output)) is None else value
                  for run in study.observations]),
        error,
        tuple(run.regime or "" for run in study.observations),
    )  # fmt: skip
    model = Model(plan, shared, unknowns, runs)
    scatter = Scatter.of(model, wanted=study.discrepancy)
    candidates = None
    if candidate_values:
        # What a candidate does not say is as in the first run.
        first_run = {name: Fixed(float(column[0])) for name, column in columns.items()}
        candidates = Grid.of({**first_run, **candidate_values})
    is_robust = study.likelihood == "student_t"
    likelihood = Likelihood(model, scatter, study.outlier_probability, is_robust)
    questions = tuple(_questions_on_tiny_errors(runs))
    return Calibration(study, plan, grid, likelihood, candidates, questions=questions)


UNITS = {name: SCENES[name] for name in ("linear-drive-unit", "bowl-drive-unit")}
"""Scenes whose amplitudes can be measured."""


def choose(name: str, method: str | None, parameters: Collection[str]) -> Chosen:
    """Return the scene of a calibration, its method or variant, and problems with that name.

    The parameters of a drive unit tell its variant, as in a study of motion on it.
    """
    if name not in UNITS:
        return choose_system(name, method, parameters)
    scene, variant, problems = choose_scene(name, None, UNITS)
    unit, unit_problems = unit_of(parameters)
    raise_any(unit_problems)
    if method is not None:
        problems.append(Problem("method", "a drive unit has only closed forms", "Remove method"))
    chosen = unit.variant if unit and unit.variant in scene.variants else variant
    return scene, chosen, problems


MINUTE = 1 / 30  # of the median error of the other runs: a run with less outweighs them all


def _questions_on_tiny_errors(runs: Runs) -> Iterable[str]:
    errors = np.where(runs.measured, runs.error, np.nan)
    for k in np.flatnonzero(errors > 0):
        median_of_others = (
            np.nanmedian(np.delete(errors, k)) if np.isfinite(errors).sum() > 1 else 0.0
        )
        if errors[k] < MINUTE * median_of_others:
            shown = ShownUnits().of(QUANTITIES[runs.output].unit, median_of_others)
            small, large = (
                f"{shown.factor * error:.2g} {shown.unit}"
                for error in (errors[k], median_of_others)
            )
            yield (
                f"run {k + 1} has an error of {small}, and the other runs of about {large}, so it "
                "outweighs them all. If the error is a percentage of a speed near 0, "
                "give it as a value"
            )


def _problems_of_fields(study: CalibrateStudy) -> Iterable[Problem]:
    if study.verify is not None:
        yield Problem(
            "verify",
            "a calibration cannot be verified",
            "Remove verify. Simulate the best values and verify that simulation",
        )
    yield from (
        Problem(
            f"parameters.{name}",
            f"{name} has several values",
            "Give one value for all runs here, or a value for each run in observations",
        )
        for name, value in study.values().items()
        if not isinstance(value, Fixed)
    )


def _unknowns(study: CalibrateStudy) -> tuple[Unknown, ...]:
    unknowns = []
    for name, prior in study.priors().items():
        table = next(
            (table_ for table_ in ("offsets", "factors") if name.startswith(STEMS[table_])),
            "unknowns",
        )
        unknowns.append(Unknown(name, name.removeprefix(STEMS[table]), table, prior))
    return tuple(unknowns)


def _problems_of_unknowns(study: CalibrateStudy) -> Iterable[Problem]:
    count = len(study.priors())
    if not count:
        yield Problem(
            "unknowns",
            "the study has no unknown parameter",
            "Add one, for example [unknowns] friction = { lower = 0.1, upper = 0.6 }",
        )
    if count > MAX_UNKNOWNS:
        yield Problem(
            "unknowns",
            f"the study has {count} unknowns, and at most {MAX_UNKNOWNS} can be estimated",
            "Give the unknowns that matter least a fixed value in [parameters]",
        )


def _columns(study: CalibrateStudy, problems: list[Problem]) -> dict[str, Array]:
    # The parameters in which the runs differ; a run that lacks one is a problem.
    rows = [parameters_of(run) for run in study.observations]
    names = [name for name in QUANTITIES if any(name in row for row in rows)]
    for name in names:
        rows_without = [k for k, row in enumerate(rows, 1) if name not in row]
        if rows_without:
            number_of_rows = f" ({len(rows_without)} rows lack it)" if len(rows_without) > 1 else ""
            problems.append(
                Problem(
                    f"observations row {rows_without[0]}, {name}",
                    f"this run has no {name}, but other runs have one" + number_of_rows,
                    f"Give {name} in every run, or once in [parameters]",
                )
            )
    columns = {name: np.array([row.get(name, np.nan) for row in rows]) for name in names}
    problems += given_twice("parameters", study.values(), "observations", columns)
    return columns


def _observed_output(study: CalibrateStudy) -> tuple[str, list[Problem]]:
    # The output that the runs measured, and the problems.
    problems, rows = [], study.observations
    for k, row in enumerate(rows, 1):
        outputs = [name for name in OBSERVED if getattr(row, name) is not None]
        if len(outputs) > 1:
            problems.append(
                Problem(
                    f"observations row {k}",
                    f"this run has {len(outputs)} measured values: {' and '.join(outputs)}",
                    "Keep one of them",
                )
            )
        elif not outputs and row.regime is None:
            problems.append(
                Problem(
                    f"observations row {k}",
                    "this run has no measured value",
                    f"Give one of {', '.join(OBSERVED)}, or the observed regime",
                )
            )
    outputs_used = [
        name for name in OBSERVED if any(getattr(row, name) is not None for row in rows)
    ]
    if len(outputs_used) > 1 and not problems:
        problems.append(
            Problem(
                "observations",
                f"{outputs_used[0]} was measured in some runs, and {outputs_used[1]} in others",
                "Give the same output in all runs",
            )
        )
    any_speed = "velocity_towards" if study.scene == PLATE else "conveying_velocity"
    return (*outputs_used, any_speed)[0], problems


def _errors(study: CalibrateStudy, output: str) -> tuple[Array, list[Problem]]:
    # The error of the value of each run, 0 if it is not known, and the problems.
    errors, runs_without, problems = [], [], list[Problem]()
    for k, run in enumerate(study.observations, 1):
        value = getattr(run, output)
        error = run.error
        if value is not None and error is None and study.error is not None and not problems:
            try:
                error = read_error(output, study.error, value)
            except UnitError as unit_error:
                problems.append(
                    Problem(
                        ("error" if value else f"observations row {k}, error"),
                        unit_error.message,
                        unit_error.fix,
                    )
                )
        if value is not None and error is None:
            runs_without.append(k)
        errors.append(error or 0.0)
    measured = sum(getattr(run, output) is not None for run in study.observations)
    if runs_without and len(runs_without) < measured and not problems:
        problems.append(
            Problem(
                f"observations row {runs_without[0]}, error",
                "this run has no error, but other runs have one",
                "Give error in every run, once for all runs at the top of the study, or in no run",
            )
        )
    return np.array(errors), problems


def _problems_of_places(
    unknowns: Iterable[Unknown], shared: Mapping[str, float], columns: Mapping[str, Array]
) -> Iterable[Problem]:
    # An unknown may not have a value, too; an offset or a factor is of a parameter that has one.
    for unknown in unknowns:
        path, names = f"{unknown.table}.{unknown.parameter}", {*shared, *columns}
        if unknown.table == "unknowns" and unknown.parameter in names:
            table = "observations" if unknown.parameter in columns else "parameters"
            yield Problem(
                path,
                f"{unknown.parameter} is an unknown, but the {table} give its value",
                f"Remove {unknown.parameter} from one of the two. To estimate an error of the "
                "given values, use [offsets] or [factors]",
            )
        elif unknown.table != "unknowns" and unknown.parameter not in names:
            yield Problem(
                path,
                f"[{unknown.table}] changes {unknown.parameter}, which has no value",
                f"Give {unknown.parameter} in [parameters] or each run, or move it to [unknowns]",
            )


def _parameter_ranges(
    unknowns: Iterable[Unknown], shared: Mapping[str, float], columns: Mapping[str, Array],
    problems: list[Problem],
) -> dict[str, Values]:  # fmt: skip
    ranges: dict[str, Values] = {}
    for name, column in columns.items():
        values = np.unique(column[~np.isnan(column)]).tolist()
        ranges[name] = Points(tuple(values)) if len(values) > 1 else Fixed(values[0])
    for unknown in unknowns:
        low, high = unknown.lower, unknown.upper
        if unknown.table != "unknowns":
            nominal = columns.get(
                unknown.parameter, np.array([shared.get(unknown.parameter, np.nan)])
            )
            range_so_far = ranges.get(unknown.parameter)
            if isinstance(range_so_far, Span):  # it has another unknown already
                nominal = np.array([range_so_far.start, range_so_far.stop])
            nominal = nominal[~np.isnan(nominal)]
            if not nominal.size:
                continue
            changes = np.array([low, high])[:, np.newaxis]
            ends = nominal + changes if unknown.table == "offsets" else nominal * changes
            low, high = float(ends.min()), float(ends.max())
        quantity = QUANTITIES[unknown.parameter]
        if low < quantity.lower or high > quantity.upper:
            bounds = ("below", quantity.lower), ("above", quantity.upper)
            word, least = bounds[low >= quantity.lower]
            problems.append(
                Problem(
                    f"{unknown.table}.{unknown.parameter}",
                    f"its range lets {unknown.parameter} go {word} {least:g}{quantity.suffix}",
                    "Narrow the range",
                )
            )
        ranges[unknown.parameter] = Span(low, high, 2) if high > low else Fixed(low)
    return ranges


def _problems_of_candidates(
    candidate_values: Mapping[str, Values],
    shared: Mapping[str, float],
    columns: Mapping[str, Array],
) -> Iterable[Problem]:
    for name in candidate_values:
        if name not in columns:
            fault = f"all runs share {name}" if name in shared else f"no run has a value of {name}"
            yield Problem(
                f"candidates.{name}", fault, "Choose parameters that differ between the runs"
            )
    cells = Grid.of(candidate_values).cells if candidate_values else 0
    if cells > MAX_CANDIDATES:
        yield Problem(
            "candidates",
            f"the study has {cells:,} candidates for the next run, at most {MAX_CANDIDATES:,} are "
            "allowed",
            "Give fewer values",
        )


def _problems_of_scene(
    study: CalibrateStudy, scene: Scene, method: str, output: str
) -> Iterable[Problem]:
    if scene.name in UNITS:
        for row, run in enumerate(study.observations, 1):
            if run.regime is not None:
                place = f"observations row {row}, regime"
                yield Problem(place, "a drive unit has no regime of a part", "Remove regime")
        if output != AMPLITUDE:
            message = f"a drive unit has no {output}"
            yield Problem(
                "observations", message, "Give the measured track_amplitude, zero to peak"
            )
    elif scene.name not in CONTACTS:
        yield Problem(
            "scene",
            f"the scene {scene.name} has no conveying velocity, which a calibration needs",
            f"Choose among {', '.join(CONTACTS)}",
        )
    yield from problems_of_settings(study, scene, method)


def _without_order_of_frictions(scene: Scene, ranges: Mapping[str, Values]) -> Scene:
    if not any(isinstance(ranges.get(name), Span) for name in STATIC_ABOVE_KINETIC.parameters):
        return scene
    others = tuple(
        constraint for constraint in scene.constraints if constraint is not STATIC_ABOVE_KINETIC
    )
    return replace(scene, constraints=others)


def _problem_of_few_runs(study: CalibrateStudy, unknowns: tuple[Unknown, ...]) -> Iterable[Problem]:
    if study.error is not None or any(run.error is not None for run in study.observations):
        return
    measured = sum(
        any(getattr(run, name) is not None for name in OBSERVED) for run in study.observations
    )
    if 0 < measured < len(unknowns) + 2:
        yield Problem(
            "error",
            f"the error of the measured values is not given, and {measured} runs are too few to "
            "estimate it",
            f'Give error, such as "5 %", or at least {len(unknowns) + 2} runs',
        )
