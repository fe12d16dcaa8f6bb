"""Check the diagnosis on sealed virtual valves whose fault it is not told, and score it.

Each trial is a valve drawn from the seed (nothing wrong, one effect, a wrong number, two at once, or something that no
candidate describes), recorded over Modbus, diagnosed, and only then unsealed. Results go to OUT/trials.jsonl one by
one: stop with Ctrl-C, and go on with the same command.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from collections.abc import Sequence

    from app.blind.trial import Order


@click.command(name="blind", help=__doc__, short_help=(__doc__ or "").partition("\n")[0])
@click.option("--trials", type=click.IntRange(min=1), default=20, show_default=True, help="How many sealed valves.")
@click.option("--seed", type=click.IntRange(min=0), default=1, show_default=True, help="Which valves; try your own.")
@click.option(
    "--out", type=click.Path(path_type=Path, file_okay=False), help="Folder of this check; may be gone on with."
)
@click.option("--family", type=click.Choice(["thesis", "reference", "both"]), default="both", show_default=True,
              help="The machine: the thesis's equations, or first principles.")  # fmt: skip
@click.option("--processes", type=click.IntRange(1, 64), default=2, show_default=True, help="Trials side by side.")
@click.option("--keep", is_flag=True, help="Keep the samples of every trial (about 2 MB each).")
@click.option("--json", "as_json", is_flag=True, help="Print the scores as JSON.")
def command(trials: int, seed: int, out: Path | None, family: str, processes: int, keep: bool, as_json: bool) -> None:
    from datetime import UTC, datetime

    from app.blind.pool import read_lines
    from app.blind.protocol import begin
    from app.blind.trial import orders
    from app.targets import check_folder

    folder = out or Path("logs/runs") / f"{datetime.now(UTC):%Y%m%dT%H%M%S}-blind"
    check_folder("--out", folder)
    every = orders(trials, seed, family, folder, keep)
    protocol = begin(folder, every, seed, family)
    done = {line["trial"] for line in read_lines(folder)}
    todo = [order for order in every if order.number not in done]
    click.echo(
        f"{trials} sealed valves, seed {seed}, family {family}: {len(done)} done, {len(todo)} to do in {processes} "
        f"processes; commitments are in {folder / 'protocol.json'}",
        err=as_json,
    )
    try:
        _run(todo, folder, processes, as_json)
    finally:  # stopped half-way, the page shows what there is
        _write(protocol, folder)
    _report(folder, as_json)


def _write(protocol: dict[str, Any], folder: Path) -> None:
    from app.blind.page import write_page
    from app.blind.pool import read_lines
    from app.blind.protocol import check
    from app.blind.score import score

    lines = read_lines(folder)
    check(protocol, lines)
    found = score(lines)
    (folder / "scores.json").write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    write_page(found, lines, protocol, folder / "blind.html")


def _run(todo: Sequence[Order], folder: Path, processes: int, quiet: bool) -> None:
    from contextlib import closing

    from app.blind.pool import run_all

    with closing(run_all(todo, folder, processes)) as results:
        for number, line in enumerate(results, start=1):
            click.echo(f"{number:4}/{len(todo)}  {_words(line)}", err=quiet)


def _words(line: dict[str, Any]) -> str:
    """A trial in one line: right or not, truth, answer."""
    if "error" in line:
        return f"BROKEN trial {line['trial']}: {line['error']}"
    label = line["label"]
    truth = " + ".join(f"{cause['name']} {cause['size']:g} {cause['unit']}" for cause in label["causes"]) or "none"
    said = ", ".join(f"{cause['name']} {cause['probability']:.2f}" for cause in line["causes"]) or line["verdict"]
    kind = "outsider: " if label["kind"] == "outsider" else ""
    mark = "right" if line["mark"]["right"] else "WRONG"
    return f"{mark}  {label['family']:9} {line['ratio']:6.1f} x floor  {kind}{truth}  ->  {said}"


def _report(folder: Path, as_json: bool) -> None:
    from app.blind.table import rows

    text = (folder / "scores.json").read_text(encoding="utf-8")
    if as_json:
        click.echo(text, nl=False)
        return
    found = json.loads(text)
    groups = found["families"] if len(found["families"]) > 1 else {}
    for name, group in {"all": found["all"], **groups}.items():
        click.echo()
        click.echo(f"{name + ', ' + str(group['trials']) + ' trials':52}{'figure':20}95 % interval")
        for what, figure, interval in rows(group):
            click.echo(f"{what:52}{figure:20}{interval}".rstrip())
    if found["broken"]:
        click.echo(f"{len(found['broken'])} trials ended in an error: {folder / 'trials.jsonl'}")
    click.echo(f"page: {folder / 'blind.html'}; scores: {folder / 'scores.json'}; trials: {folder / 'trials.jsonl'}")
