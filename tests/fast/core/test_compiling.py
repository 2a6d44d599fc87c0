"""Who waits for the compiler is told, once, and nobody else is."""

import vibrafeed
from vibrafeed.core import kinds
from vibrafeed.core.compiling import ONCE, announced, stopwatch

STUDY = {
    "kind": "sweep", "scene": "rectangle-on-plane", "outputs": ["throw_number"],
    "parameters": {"frequency": 50, "amplitude": "0.2 mm", "beta": 20},
}  # fmt: skip


def compile_twice() -> None:
    for _ in range(2):
        stopwatch.begin()
        stopwatch.end()


def test_it_is_said_once_and_within_the_block():
    said: list[str] = []
    compile_twice()
    with announced(said.append):
        assert said == []
        compile_twice()
        assert said == [ONCE]
    compile_twice()
    assert said == [ONCE]


def test_a_function_of_python_says_it_on_the_error_stream(monkeypatch, capsys):
    plain = kinds.tabulate

    def tabulate(*arguments):
        compile_twice()
        return plain(*arguments)

    vibrafeed.sweep(STUDY)
    assert capsys.readouterr().err == ""
    monkeypatch.setattr(kinds, "tabulate", tabulate)
    vibrafeed.sweep(STUDY)
    told = capsys.readouterr()
    assert (told.err, told.out) == (f"vibrafeed: {ONCE}\n", "")
