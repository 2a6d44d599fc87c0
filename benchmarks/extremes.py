"""The hard cases, as Markdown; run `python -m benchmarks.extremes`."""

from __future__ import annotations

import sys

from core.accuracy.extremes import run_catalogue, to_markdown


def main() -> None:
    """Print the report; end with 1 if a case is wrong."""
    outcomes = run_catalogue()
    print(to_markdown(outcomes))
    sys.exit(not all(outcome.passed for outcome in outcomes))


if __name__ == "__main__":
    main()
