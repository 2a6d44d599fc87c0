"""The command line: `python -m vibrafeed`, and what the command `vibrafeed` runs."""

from __future__ import annotations


def main() -> None:
    """Run the command line."""
    from vibrafeed.app.cli import main

    main()


if __name__ == "__main__":
    main()
