"""Compute single figures and numbers of the thesis on the virtual valve."""

from __future__ import annotations

import json
from pathlib import Path

import click


@click.command(name="thesis")
@click.argument("keys", nargs=-1, metavar="[KEY]...")
@click.option("--plot", type=click.Path(path_type=Path, file_okay=False), help="Folder for the pictures.")
@click.option("--json", "as_json", is_flag=True, help="For scripts.")
def command(keys: tuple[str, ...], plot: Path | None, as_json: bool) -> None:
    """Compute single figures and numbers of the thesis on the virtual valve.

    KEY is the number of a figure (1-2, 3-10), `beyond`, `brake` or `rivals`; without one, the keys are listed. `brake`
    and `rivals` take minutes, the others seconds.
    """
    from app.gallery import figure, page
    from app.gallery.index import KEYS, checked, make
    from app.targets import check_folder

    if not keys:
        click.echo(" ".join(KEYS))
        return
    if plot is not None:
        check_folder("--plot", plot)
    made = [make(key) for key in checked(keys)]
    for entry in made:
        if plot is not None:
            figure.save(entry, plot)
        if not as_json:
            click.echo(f"{entry.title}\n  thesis: {entry.said or '-'}\n  here:   {entry.found}")
            for n in entry.numbers:
                said = "" if n.thesis is None else f"   (thesis: {n.thesis:g})"
                click.echo(f"    {n.label}: {page.text(n)} {n.unit}{said}")
    if as_json:
        click.echo(json.dumps(page.stored(made), indent=1))
