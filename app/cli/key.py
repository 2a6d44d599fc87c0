"""`vibrafeed key`: a key for the HTTP interface."""

from __future__ import annotations

import typer


def key() -> None:
    """Make a key for the HTTP interface; print it and the hash that the service is given."""
    from app.web.guard import new_key

    made, digest = new_key()
    typer.echo(f"key   {made}")
    typer.echo(f"hash  {digest}")
    typer.echo(f"Set VIBRAFEED_API_KEY_HASHES={digest} for the service; commas part several.")
    typer.echo("Clients send `Authorization: Bearer KEY`. The key is kept nowhere: note it now.")
