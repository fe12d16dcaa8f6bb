"""Rebuild docs/thesis.md: every figure and number of the thesis next to ours."""

from __future__ import annotations

from pathlib import Path

import click


@click.command(name="gallery")
@click.option("--out", type=click.Path(path_type=Path, file_okay=False), default=Path("docs"), show_default=True,
              help="Folder of the page.")  # fmt: skip
@click.option("--check", is_flag=True, help="Write nothing; fail if the stored numbers are stale.")
def command(out: Path, check: bool) -> None:
    """Rebuild docs/thesis.md with its pictures, or check that it is not stale. Takes five minutes."""
    from app.gallery import page

    made = []
    for entry in page.entries():
        click.echo(f"{entry.key:8s} {entry.title}", err=True)
        made.append(entry)
    if check:
        page.check(out, made)
        click.echo(f"{out / 'thesis.json'}: {sum(len(e.numbers) for e in made)} numbers are as stored")
        return
    page.write(out, made)
    click.echo(f"{out / 'thesis.md'}: {len(made)} items")
