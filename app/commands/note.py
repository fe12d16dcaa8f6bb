"""Add a note to a run, running or finished."""

from __future__ import annotations

import click


@click.command()
@click.argument("run")
@click.argument("text", nargs=-1, required=True)
def command(run: str, text: tuple[str, ...]) -> None:
    """Add a note to RUN: a run folder, a name out of `lostmotion runs`, or `latest`.

    A note made while the run goes on stands at its last sample, one made afterwards behind its end. Nothing that was
    recorded is changed.
    """
    from hal.errors import BadInput
    from logs.find import find_record
    from logs.notes import add_note

    words = " ".join(text).strip()
    if not words:
        raise BadInput("the note is empty; write what you want to remember")
    path = find_record(run)
    at_s = add_note(path, words)
    click.echo(f"noted in {path}" + (f" at {at_s:.1f} s" if at_s is not None else ", after its end"))
