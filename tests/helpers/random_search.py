"""Random studies of all kinds against a running server, which ends in no error of its own.

Posted are studies of any scene, variant, method and setting, with values inside their bounds, at
them and just beyond. What is accepted as a job is dismissed, one of `FOLLOWED` after it has been
followed for a while. Told are replies by status, every 5xx and every job that failed by the
service's fault, with its study.
"""

from __future__ import annotations

import itertools
import json
import shutil
import threading
import time
import urllib.error
import urllib.request
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from benchmarks.serving import Served, served
from vibrafeed.app.settings import Settings
from vibrafeed.core.catalogue import describe
from vibrafeed.core.errors import StudyError, VibrafeedError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.motion.systems import SYSTEMS
from vibrafeed.core.optimise.methods import METHODS
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.scenes import SCENES
from waiting import PATIENCE

FOLLOWED = 25
LOOKS = 25  # at a job that is followed, 0.2 s apart
CLIENTS = 4
ROUNDS = 6

SETTINGS = {
    "tolerance": (1e-13, 1.0),
    "max_periods": (8, 100_000),
}
"""Settings of motion and their bounds in the schema."""

INSTEAD = (
    (("friction_static", "friction_kinetic"), ("friction",)),
    (("peak_to_peak",), ("amplitude",)),
    (("vertical_amplitude", "vertical_peak_to_peak"), ()),
)
"""Parameters that stand for one another."""

Random = np.random.Generator
Content = dict[str, Any]


def drawn(random: Random, low: float, high: float) -> float:
    """Return a number between two bounds, or one of them, or one just beyond."""
    inside = float(np.exp(random.uniform(np.log(low), np.log(high))))
    return float(random.choice([inside] * 6 + [low, high, low / 2, high * 2, low * (1 - 1e-15)]))


def value(random: Random, name: str) -> Any:
    """Return a value of a parameter: mostly as examples have it, else at its ends or beyond."""
    quantity = QUANTITIES[name]
    low, high = quantity.lower, quantity.upper
    extreme = [low, high, low - 1e-9, high + 1e-9, 0.0, 1e-300, 1e300, -1.0, 1e-12, 1e12, 5e-324]
    if random.random() < 0.02:
        return float(random.choice([x for x in extreme if np.isfinite(x)]))
    example = str(random.choice(quantity.examples)) if quantity.examples else "1"
    number, _, unit = example.partition(" ")
    try:
        scaled = float(number) * float(np.exp(random.normal(0.0, 0.7)))
    except ValueError:
        return example
    word = f"{scaled:.6g} {unit}".strip()
    if random.random() < 0.2:
        stop = f"{scaled * random.uniform(1.0, 3.0):.6g} {unit}".strip()
        size = int(2 + np.exp(random.uniform(0.0, 4.0)))
        return {"start": word, "stop": stop, "num": size}
    if random.random() < 0.03:
        return [word, word, "x", {"a": 1}, None, float(number)][random.integers(6) :]
    return word


def parameters(random: Random, told: Content) -> Content:
    """Return values of what a scene needs, of some of what it may be given, seldom of others."""
    given = {}
    for one in told["parameters"]:
        needed = one.get("default") is None
        if needed or random.random() < 0.3:
            given[one["name"]] = value(random, one["name"])
    for one, other in INSTEAD:
        if random.random() < 0.97:
            for name in one if random.random() < 0.6 else other:
                given.pop(name, None)
    if given and random.random() < 0.05:
        given.pop(str(random.choice(list(given))))
    if random.random() < 0.05:
        name = str(random.choice(list(QUANTITIES)))
        given[name] = value(random, name)
    return given


def mended(random: Random, content: Content) -> Content:
    """Return a study without what it would be refused for, as far as that is soon found."""
    for _ in range(ROUNDS):
        try:
            prepare_content(content)
        except StudyError as error:
            for problem in error.problems:
                first, _, name = problem.place.partition(".")
                name = name.partition(".")[0]
                if first == "parameters" and name in content["parameters"]:
                    removed = content["parameters"].pop(name)
                    examples = QUANTITIES[name].examples
                    if (examples and isinstance(removed, dict | list)) or random.random() < 0.3:
                        content["parameters"][name] = str(random.choice(examples or ("1",)))
                elif first == "parameters" and name in QUANTITIES:
                    content["parameters"][name] = str(random.choice(QUANTITIES[name].examples))
                elif first not in ("kind", "scene", "parameters", "criterion"):
                    content.pop(first, None)
        else:
            break
    return content


def outputs(random: Random, told: Content) -> list[str]:
    """Return some outputs of a scene."""
    names = [one["name"] for one in told["outputs"]]
    count = int(random.integers(1, 4))
    return [str(name) for name in random.choice(names, min(count, len(names)), replace=False)]


def study(random: Random) -> Content:
    """Return the content of a study of any kind."""
    kind = str(random.choice(["sweep", "simulate", "simulate", "optimise"]))
    if kind == "simulate":
        scene = str(random.choice(list(SYSTEMS)))
        method = str(random.choice(list(SYSTEMS[scene].variants)))
        told = describe(scene, method=method)
        content: Content = {"method": method}
        known = SYSTEMS[scene].variant_defaults.get(method, {})
        for name, bounds in SETTINGS.items():
            if random.random() < (0.4 if name in known else 0.02):
                number = drawn(random, *bounds)
                content[name] = number if isinstance(bounds[0], float) else int(number)
        if random.random() < 0.1:
            content["trajectory"] = [
                int(random.integers(0, 60)),
                [0.0, 10 ** random.uniform(-6, 9)],
            ][random.integers(2)]
    else:
        scene = str(random.choice(list(SCENES)))
        variant = str(random.choice(list(SCENES[scene].variants)))
        told = describe(scene, variant)
        content = {"variant": variant} if random.random() < 0.7 else {}
    content |= {"kind": kind, "scene": scene, "parameters": parameters(random, told)}
    if kind == "optimise":
        output, against = [*outputs(random, told), *outputs(random, told)][:2]
        ways: list[Content] = [
            {"kind": "maximise", "output": output},
            {"kind": "minimise", "output": output},
            {
                "kind": "weighted",
                "output": output,
                "against": against,
                "weight": random.uniform(0, 3),
            },
            {
                "kind": "pareto",
                "output": output,
                "against": against,
                "points": int(drawn(random, 2, 60)),
            },
            {
                "kind": "limit",
                "output": output,
                "against": against,
                "limit": drawn(random, 1e-3, 1e3),
            },
        ]
        content["criterion"] = ways[random.integers(len(ways))]
        if random.random() < 0.3:
            content["method"] = str(random.choice(list(METHODS)))
        if random.random() < 0.4:
            names = list(content["parameters"]) or ["beta"]
            name = str(random.choice(names))
            content["parameters"].pop(name, None)
            low = random.uniform(0.0, 1.0)
            content["variables"] = {name: {"lower": low, "upper": low + random.uniform(-0.1, 1.0)}}
    elif random.random() < 0.8:
        content["outputs"] = outputs(random, told)
    if kind == "sweep" and random.random() < 0.15:
        axes = list(content["parameters"]) or ["beta"]
        content["reduce"] = {"over": [str(random.choice(axes))], "statistics": ["max", "mean"]}
    if random.random() < 0.1:
        content["verify"] = int(random.integers(0, 20))
    return content


class Search:
    """Posts studies and keeps what is wrong.

    Attributes
    ----------
    statuses : Counter
        Replies by status.
    wrong : list of str
        What should not have been.
    """

    def __init__(self, server: Served):
        self._server = server
        self._lock = threading.Lock()
        self._jobs = itertools.count()
        self.statuses: Counter[str] = Counter()
        self.wrong: list[str] = []

    def post(self, content: Content) -> None:
        """Post a study, and look at what becomes of it."""
        status, document = self._ask("POST", f"/processes/{content['kind']}/execution", content)
        self._count(str(status))
        if status == 507 and self._is_too_large(content):
            return
        if status >= 500:
            self._tell(f"{status} {document.get('detail')}", content)
        elif status == 200:
            self._look_at_own(content)
        elif status == 201:
            self._follow(document["jobID"], content)

    def _follow(self, number: str, content: Content) -> None:
        if next(self._jobs) % FOLLOWED == 0:
            for _ in range(LOOKS):
                _, job = self._ask("GET", f"/jobs/{number}")
                if job["status"] not in ("accepted", "running"):
                    break
                time.sleep(0.2)
            self._count(f"job {job['status']}")
            if job["status"] == "failed":
                status, problem = self._ask("GET", f"/jobs/{number}/results")
                if status >= 500:
                    self._tell(f"failed job: {problem.get('detail')}", content)
        status, _ = self._ask("DELETE", f"/jobs/{number}")
        if status >= 500:
            self._tell(f"{status} to its dismissal", content)

    def _look_at_own(self, content: Content) -> None:
        """Say so if what the service took is refused in this process."""
        try:
            prepare_content(content)
        except VibrafeedError as error:
            self._tell(f"accepted, and refused here: {error}", content)

    def _is_too_large(self, content: Content) -> bool:
        """True if a result cannot be stored here: beyond the quota, or the disk is smaller."""
        prepared = prepare_content(content)
        quota = Settings.model_fields["disk_quota_bytes"].default
        free = shutil.disk_usage(self._server.data).free
        return prepared.bytes + prepared.computed_bytes > min(quota, free)

    def _ask(self, method: str, path: str, content: Any = None) -> tuple[int, Any]:
        data = None if content is None else json.dumps(content).encode()
        headers = {"Content-Type": "application/json", "Accept": "application/json"}
        request = urllib.request.Request(self._server.address + path, data, headers, method=method)
        try:
            with urllib.request.urlopen(request, timeout=PATIENCE) as reply:
                return reply.status, json.load(reply)
        except urllib.error.HTTPError as error:
            with error:
                return error.code, json.load(error)

    def _count(self, name: str) -> None:
        with self._lock:
            self.statuses[name] += 1

    def _tell(self, what: str, content: Content) -> None:
        with self._lock:
            self.wrong.append(f"{what}: {json.dumps(content)}")
            print(self.wrong[-1], flush=True)


def studies(seed: int, count: int) -> Iterator[Content]:
    """Yield random studies."""
    random = np.random.default_rng(seed)
    for _ in range(count):
        content = study(random)
        yield content if random.random() < 0.3 else mended(random, content)


def searched(count: int, seed: int) -> tuple[Search, int]:
    """Post random studies to a server of its own; return what was found, and its memory [bytes]."""
    with served(max_queue=1000) as server, ThreadPoolExecutor(CLIENTS) as clients:
        search = Search(server)
        for _ in clients.map(search.post, studies(seed, count)):
            pass
        return search, server.memory()
