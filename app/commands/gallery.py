"""Rebuild docs/thesis.md: every figure and number of the thesis next to ours."""

from __future__ import annotations

import time
from pathlib import Path

import click


@click.command(name="gallery")
@click.argument("keys", nargs=-1, metavar="[KEY]...")
@click.option("--out", type=click.Path(path_type=Path, file_okay=False), default=Path("docs"), show_default=True,
              help="Folder of the page.")  # fmt: skip
@click.option("--check", is_flag=True, help="Write nothing; fail if numbers, texts or pictures are stale.")
def command(keys: tuple[str, ...], out: Path, check: bool) -> None:
    """Rebuild docs/thesis.md with its pictures, or items KEY of it, or check that they are not stale.

    KEY is as for `lostmotion thesis`. All together take five to ten minutes, most of them for `brake` and `rivals`.
    """
    from app.gallery import page, stale
    from app.gallery.index import checked, make
    from app.targets import check_folder
    from hal.errors import JobFailed

    chosen = checked(keys)
    if not check:
        check_folder("--out", out)
    found: dict[str, int] = {}
    for number, key in enumerate(chosen, start=1):
        started_s = time.monotonic()
        click.echo(f"[{number}/{len(chosen)}] {key:8s}", nl=False, err=True)
        entry = make(key)
        differences = stale.differences(out, entry) if check else []
        if not check:
            page.write(out, [entry])  # one by one, so that an interrupted rebuild keeps what it has
        said = f"{len(differences)} STALE" if differences else "as stored" if check else "written"
        click.echo(f"{said}, {time.monotonic() - started_s:.1f} s", err=True)
        for each in differences:
            click.echo(f"    {each}", err=True)
        found |= {key: len(differences)} if differences else {}
    if found:
        raise JobFailed(f"{out / 'thesis.md'} is stale; run `lostmotion gallery {' '.join(found)}`")
    click.echo(f"{out / 'thesis.md'}: {len(chosen)} items {'are as stored' if check else 'written'}")
