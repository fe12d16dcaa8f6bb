"""Reveal what was wrong with a sealed valve, once its diagnosis is written."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from sim_device.sealed import Label


@click.command()
@click.argument("run", type=click.Path(exists=True, file_okay=False, path_type=Path))
@click.argument("seed")
@click.option("--commitment", type=click.Path(path_type=Path), help="The commitment file.  [default: RUN/sealed.json]")
@click.option("--json", "as_json", is_flag=True, help="Print JSON for scripts.")
def command(run: Path, seed: str, commitment: Path | None, as_json: bool) -> None:
    """Reveal what was wrong with the sealed valve of RUN, drawn from SEED.

    It refuses before RUN has a diagnosis.json, and checks the commitment that was made before the recording.
    """
    from sim_device.sealed import unseal

    label = unseal(run, seed, commitment)
    if as_json:
        click.echo(json.dumps(asdict(label), indent=1))
        return
    click.echo(f"sealed: {_truth(label)}")
    click.echo(f"found:  {_found(run / 'diagnosis.json')}")


def _truth(label: Label) -> str:
    if not label.causes:
        return f"nothing is wrong with this {label.family} valve; the commitment holds"
    causes = " and ".join(
        f"{cause.key} {cause.size:g}{'' if cause.unit == '1' else ' ' + cause.unit} ({cause.grade})"
        for cause in label.causes
    )
    return f"{label.kind}: {causes}, on the {label.family} valve; the commitment holds"


def _found(path: Path) -> str:
    """What the diagnosis says, in one line.

    Raises: `BadInput` when the file is not a diagnosis.
    """
    from hal.errors import BadInput

    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        causes = [f"{cause['name']} (probability {cause['probability']:.2f})" for cause in content["causes"]]
        return str(content["verdict"]) + (": " + ", ".join(causes) if causes else "")
    except (ValueError, KeyError, TypeError) as error:
        raise BadInput(f"{path}: this is not a diagnosis ({error})") from error
