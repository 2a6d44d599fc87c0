"""The options of a benchmark's command line, read in one way."""

from __future__ import annotations

import argparse
from typing import Any


def options(about: str | None, *names: str, **known: Any) -> argparse.Namespace:
    """Return the options of a benchmark's command line.

    Parameters
    ----------
    about : str
        What the benchmark prints; its first line is shown as help.
    names : str
        Words that may stand without an option, any of them; those that do are `names`.
    known
        Each option with its default, whose type its value has; False is a switch, and a type alone
        is that of an option without a default. A list takes any number of values, of the type in
        it, or of that of its defaults. A pair has the words of its help beside it.
    """
    parser = argparse.ArgumentParser(description=(about or "").partition("\n")[0])
    if names:
        words = ", ".join(names)
        parser.add_argument("names", nargs="*", choices=[[], *names], default=[], help=words)
    for name, value in known.items():
        default, words = value if isinstance(value, tuple) else (value, None)
        flag = f"--{name.replace('_', '-')}"
        if default is False:
            parser.add_argument(flag, action="store_true", help=words)
        elif isinstance(default, list):
            kind = default[0] if isinstance(default[0], type) else type(default[0])
            default = [] if kind is default[0] else default
            parser.add_argument(flag, type=kind, nargs="*", default=default, help=words)
        elif isinstance(default, type):
            parser.add_argument(flag, type=default, help=words)
        else:
            parser.add_argument(flag, type=type(default), default=default, help=words)
    return parser.parse_args()
