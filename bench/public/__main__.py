"""What the diagnosis makes of public recordings: `python -m bench.public CLONES --out DIR [--only WORD]`.

CLONES holds clones of the repositories that `loops.py` and `machines.py` name, each under its own name; what is not
there is left out. Prints the rows of the table in docs/real-data.md. What was answered once stays in DIR.
"""

from __future__ import annotations

import argparse
import json
import subprocess
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

from bench.called import LIMIT_S, call
from bench.public import loops, machines
from bench.public.recording import Recording

_SETS: Mapping[str, Callable[[Path, Path], Iterator[Recording]]] = {
    loops.FOLDER: loops.recordings,
    "ValveActuator-DAMADICS-": machines.damadics,
    "Measuring-Backlash-in-Popular-UART-Servos": machines.servos,
    "camber-control": machines.cylinders,
    "system_norm_koopman": machines.rig,
}
#: [any unit]; a limit that is none, or a point of a curve that is nothing.
_NIL = 1e-9
_HEAD = "| recording | known | gap: as given, re-tuned, with the causes, noise [%] | the answer | not told apart from |"


def found(clones: Path, work: Path) -> Iterator[Recording]:
    """All recordings of the sets that are there."""
    for folder, recordings in _SETS.items():
        if (clones / folder).is_dir():
            yield from recordings(clones / folder, work)


def answered(out: Path, one: Recording) -> dict[str, Any]:
    """What `diagnose` says of a recording, or the `error` with which it ends."""
    place = out / f"{one.group} {one.name}".replace(",", "").replace(" ", "-").replace(":", "")
    if (said := _whole(place)) is not None:
        return said
    try:
        call("diagnose", str(one.file), *one.words, "--out", str(place))
    except subprocess.TimeoutExpired:
        return {"error": f"no answer in {LIMIT_S:g} s"}
    except subprocess.CalledProcessError as error:
        return {"error": error.stderr.strip().splitlines()[-1]}
    return _whole(place) or {"error": "interrupted"}


def _whole(place: Path) -> dict[str, Any] | None:
    """The answer that is there; one that was interrupted, and says only what was known by then, is none."""
    path = place / "diagnosis.json"
    said: dict[str, Any] = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {"complete": False}
    return said if said["complete"] else None


def row(one: Recording, said: Mapping[str, Any]) -> str:
    """A row of the table."""
    if "error" in said:
        return f"| {one.group}, {one.name} | {one.known} | - | {said['error']} | |"
    gap = said["gap"]
    keys = ("before", "retuned", "after", "noise_floor")
    errors = ", ".join("-" if gap.get(key) is None else f"{gap[key]:.2g}" for key in keys)
    causes = said["causes"]
    names = ", ".join(_named(cause) for cause in causes)
    alike = ", ".join(sorted({name for group in said["confusable"] for name in group} - {c["name"] for c in causes}))
    return f"| {one.group}, {one.name} | {one.known} | {errors} | {names or said['verdict']} | {alike} |"


def _named(cause: Mapping[str, Any]) -> str:
    """A cause with the first of its parameters that is not nil, which says how large it is."""
    size = next((p for p in cause["parameters"].values() if abs(p["value"]) > _NIL), None)
    how_large = f" {size['value']:.2g} {size['unit']}" if size else ""
    return f"{cause['name']}{how_large} ({cause['probability']:.2f})"


def main() -> None:
    """Answers what is not answered yet, two at a time, and prints the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("clones", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--only", default="", help="a word that the group has to hold")
    parser.add_argument("--processes", type=int, default=2)
    options = parser.parse_args()
    work = options.out / "files"
    work.mkdir(parents=True, exist_ok=True)
    every = [one for one in found(options.clones, work) if options.only in one.group]
    print(_HEAD, "|---|---|---|---|---|", sep="\n")
    with ThreadPoolExecutor(options.processes) as pool:
        for one, said in zip(every, pool.map(partial(answered, options.out), every), strict=True):
            print(row(one, said), flush=True)


if __name__ == "__main__":
    main()
