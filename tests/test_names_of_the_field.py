"""Names that leave a function are nouns of the field, and docstrings say and do not ask.

`docs/glossary.md` has the words. Those of `WORDS` say nothing to who reads a name far from where it
was made: they may stand in five lines and no longer. What is left has its reason here.
"""

from __future__ import annotations

import ast
import functools
import re
from collections import Counter, defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).parents[1]
SOURCES = ("core", "app", "vibrafeed")

WORDS = {
    "found": "result, optima, roots, ...", "given": "inputs, parameters", "told": "reported",
    "one": "its noun", "place": "path, position, index", "places": "paths, positions, indices",
    "answer": "result, optimum", "answers": "results, optima",
}  # fmt: skip
"""Words that may not leave a function, in no name that is built of them, and what to say."""

DIALECT = {
    "course": "trajectory, progress", "heap": "mode", "heaps": "modes", "doubt": "error",
    "drawn": "sampled", "meant": "nominal", "hands": "executor", "desk": "admission",
    "carrier": "dispatcher", "aside": "thread pool", "holdings": "ownership", "sound": "valid",
    "standing": "certificate", "wrong": "problems, invalid", "away": "distance",
}  # fmt: skip
"""Words of our own in names of modules, functions, classes, constants and attributes."""

LINES = 5
"""As long may a variable live that is called by one of `WORDS`."""

ALLOWED = {
    # Released keys of replies and files, and what they are called in the code.
    "vibrafeed.core.errors.Problem.place": "`place` of a problem, in replies and in messages",
    "vibrafeed.app.web.replies.ProblemItem.place": "the same, in the OpenAPI document",
    "vibrafeed.core.plots.pictures.PlotError.__init__.place": "the same",
    "vibrafeed.core.intake.section.Stranger.place": "the same, of a key that nothing knows",
    "vibrafeed.core.intake.section.Section.place": "makes it",
    "vibrafeed.core.study.*.places": "where each parameter's problem is said to be",
    "vibrafeed.core.study.*.output_places": "where each output's problem is said to be",
    # Answers to questions: `vibrafeed new` asks.
    "vibrafeed.app.cli.new.*": "answers to the questions that it asks",
    "vibrafeed.app.cli.questions.*": "the same",
    "vibrafeed.app.cli.starter.*": "the same",
    # Words that mean themselves.
    "vibrafeed.app.jobs.errors.NotFoundError": "HTTP 404, Not Found",
    "vibrafeed.core.scenes.orienting_line.Device.place": "a key's number, as in `wiper_height_2`",
    # The rows set it, and are under other work: `trajectory` then.
    "vibrafeed.core.motion.method.Method.course": "of rows, too",
    "vibrafeed.core.mechanics.rolling.RollingContact.runs_away": "a motion without bound",
    "vibrafeed.core.motion.kernels.means.runs_away": "the same",
    "vibrafeed.core.motion.kernels.planar.chaos.FollowedRun.runs_away": "the same",
    "vibrafeed.core.motion.kernels.planar.chaos.ran_away": "the same",
    "vibrafeed.core.motion.kernels.planar.along.slides_away": "the same",
}
"""Names that stay, by module and name, `*` for all of a module, each with its reason."""

ROWS = (
    "vibrafeed.core.motion.kernels.rows.",
    "vibrafeed.core.motion.row_",
    "vibrafeed.core.motion.rows",
)
"""Rooms that are under other work."""
MAX_ROWS = 19
MAX_QUESTIONS_OF_ROWS = 35

QUESTION = re.compile(
    r"(?:(?:Return|Returns|Yield|Say|Tell) )?(?:what|whether|how|where|which|when|who|why)\b", re.I
)
"""A docstring that begins so asks: 'Return how many there are' says 'Return their number'."""


class Name(NamedTuple):
    """A name, where it is, and of which sort: what leaves a function, or a variable that lives."""

    where: str
    line: int
    word: str
    sort: str


def tokens(name: str) -> list[str]:
    return [part.lower() for part in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+", name)]


@functools.cache
def is_of(name: str, words: frozenset[str]) -> bool:
    """True if a name is built of a word; `one` before a noun is a number, as in `one_hop`."""
    parts = tokens(name)
    return any(part in words for part in parts if part != "one") or (
        "one" in words and parts[-1:] == ["one"]
    )


def arguments(function: ast.FunctionDef | ast.AsyncFunctionDef) -> list[ast.arg]:
    args = function.args
    return [*args.posonlyargs, *args.args, *args.kwonlyargs]


SCOPES = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Lambda)
LOOPS = (ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)


def own(function: ast.AST) -> list[tuple[ast.AST, frozenset[str]]]:
    """Return what stands in a function, with the names that a comprehension has for itself."""
    inside, left = [], [(node, frozenset()) for node in ast.iter_child_nodes(function)]
    while left:
        node, hidden = left.pop()
        if isinstance(node, SCOPES):
            continue
        if isinstance(node, LOOPS):
            targets = [part for one in node.generators for part in ast.walk(one.target)]
            hidden |= {part.id for part in targets if isinstance(part, ast.Name)}
        inside.append((node, hidden))
        left += [(child, hidden) for child in ast.iter_child_nodes(node)]
    return inside


def variables(function: ast.FunctionDef | ast.AsyncFunctionDef, where: str) -> Iterator[Name]:
    """Yield what a function sets and returns, and its variables that live for long."""
    lines, stored, returned = defaultdict(list), set(), set()
    for node, hidden in own(function):
        if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
            owner = where.rpartition(".")[0]
            yield Name(f"{owner}.{node.attr}", node.lineno, node.attr, "leaves")
        if isinstance(node, ast.Name) and node.id not in hidden:
            lines[node.id].append(node.lineno)
            if isinstance(node.ctx, ast.Store):
                stored.add(node.id)
        elif isinstance(node, ast.Return) and node.value is not None:
            parts = node.value.elts if isinstance(node.value, ast.Tuple) else [node.value]
            returned |= {part.id for part in parts if isinstance(part, ast.Name)}
    for name in stored - {arg.arg for arg in arguments(function)}:
        if name in returned:
            yield Name(f"{where}.{name}", min(lines[name]), name, "leaves")
        elif max(lines[name]) - min(lines[name]) >= LINES:
            yield Name(f"{where}.{name}", min(lines[name]), name, "lives")


def names(tree: ast.AST, where: str) -> Iterator[Name]:
    """Yield the names of a module that leave it or a function of it."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.ClassDef):
            yield Name(f"{where}.{node.name}", node.lineno, node.name, "leaves")
            yield from names(node, f"{where}.{node.name}")
        elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            here = f"{where}.{node.name}"
            yield Name(here, node.lineno, node.name, "leaves")
            for arg in arguments(node):
                yield Name(f"{here}.{arg.arg}", arg.lineno, arg.arg, "parameter")
            yield from variables(node, here)
            yield from names(node, here)
        elif isinstance(node, ast.Assign | ast.AnnAssign) and isinstance(
            tree, ast.Module | ast.ClassDef
        ):
            for target in node.targets if isinstance(node, ast.Assign) else [node.target]:
                for part in ast.walk(target):
                    if isinstance(part, ast.Name):
                        yield Name(f"{where}.{part.id}", part.lineno, part.id, "leaves")
        elif isinstance(node, ast.stmt | ast.excepthandler | ast.match_case):
            yield from names(node, where)


def module_of(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    parts = parts if parts[0] == "vibrafeed" else ("vibrafeed", *parts)
    return ".".join(parts).removesuffix(".__init__")


@functools.cache
def trees() -> tuple[tuple[str, ast.Module], ...]:
    paths = [path for top in SOURCES for path in sorted((ROOT / top).rglob("*.py"))]
    return tuple((module_of(path), ast.parse(path.read_text(encoding="utf-8"))) for path in paths)


OF_WORDS, OF_DIALECT = frozenset(WORDS), frozenset(DIALECT)
PATTERNS = {allowed: re.compile(re.escape(allowed).replace(r"\*", ".+")) for allowed in ALLOWED}


def faults(module: str, tree: ast.Module) -> list[Name]:
    """Return the names of a module that are built of words of the lists."""
    known = [
        name for name in names(tree, module)
        if is_of(name.word, OF_WORDS) or (name.sort == "leaves" and is_of(name.word, OF_DIALECT))
    ]  # fmt: skip
    if is_of(module.rpartition(".")[2], OF_WORDS | OF_DIALECT):
        known.append(Name(module, 1, module, "leaves"))
    return known


@functools.cache
def every_fault() -> tuple[Name, ...]:
    return tuple(name for module, tree in trees() for name in faults(module, tree))


def test_names_that_leave_a_function():
    assert len(trees()) > 300
    left = [
        name for name in every_fault()
        if not any(pattern.fullmatch(name.where) for pattern in PATTERNS.values())
    ]  # fmt: skip
    others = [name for name in left if not name.where.startswith(ROWS)]
    assert others == [], "\n".join(f"{name.where}, line {name.line}" for name in others)
    assert len(left) <= MAX_ROWS


def test_what_is_allowed_is_there():
    unused = [
        allowed for allowed, pattern in PATTERNS.items()
        if not any(pattern.fullmatch(name.where) for name in every_fault())
    ]  # fmt: skip
    assert unused == []


def questions(module: str, tree: ast.Module) -> list[str]:
    """Return the docstrings of a module that ask and do not say."""
    asking = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            said = ast.get_docstring(node) or ""
            if QUESTION.match(said):
                name = getattr(node, "name", "")
                asking.append(f"{module}.{name}: {said.splitlines()[0]}")
    return asking


def test_docstrings_do_not_ask():
    asking = [said for module, tree in trees() for said in questions(module, tree)]
    others = [said for said in asking if not said.startswith(ROWS)]
    assert others == [], "\n".join(others)
    assert len(asking) <= MAX_QUESTIONS_OF_ROWS


RENAMED = {
    "numpy as np": "as everybody does",
    "sys as _sys": "",
    "import_module as _import_module": "",
}
"""Imports under another name; `vibrafeed` hands over no name of a library."""


def test_no_import_dodges_a_homonym():
    renamed = Counter(
        f"{alias.name} as {alias.asname}"
        for _, tree in trees()
        for node in ast.walk(tree)
        if isinstance(node, ast.Import | ast.ImportFrom)
        for alias in node.names
        if alias.asname
    )
    assert renamed.keys() == RENAMED.keys()


@pytest.mark.parametrize(
    ("source", "words"),
    [
        ("def f(found):\n    return 1", ["found"]),
        ("def given_of(x):\n    return x", ["given_of"]),
        ("FOUND_AT = 1\nclass Told:\n    place: int", ["FOUND_AT", "Told", "place"]),
        ("def f(x):\n    found = x\n    return found", ["found"]),
        ("def f(x):\n    found = x\n    return found + 1", []),
        ("def f(x):\n    told = x\n" + "    x += 1\n" * 5 + "    x += told", ["told"]),
        ("def f(x):\n    x = [one for one in x]\n" + "    x += 1\n" * 5 + "    one = 1", []),
        ("class A:\n    def f(self, x):\n        self.answer = x", ["answer"]),
        ("def one_hop(x):\n    return x\ndef as_one(x):\n    return x", ["as_one"]),
        ("def wrong_names(x):\n    wrong = x\n    return x + wrong", ["wrong_names"]),
    ],
)  # fmt: skip
def test_planted_names_are_found(source, words):
    assert sorted(name.word for name in faults("m", ast.parse(source))) == sorted(words)


def test_planted_questions_are_found():
    source = (
        '"""What it is."""\ndef f():\n    """Return whether it is so."""\ndef g():\n    """True."""'
    )
    assert len(questions("m", ast.parse(source))) == 2
