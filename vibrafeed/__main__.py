"""The command line: `python -m vibrafeed`, and what the command `vibrafeed` runs."""

from __future__ import annotations

from vibrafeed._packages import claim


def main() -> None:
    """Run the command line."""
    claim("app")
    from app.cli import main

    main()


if __name__ == "__main__":
    main()
