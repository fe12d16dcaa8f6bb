"""A stranger tests the diagnosis: `python -m bench.stranger.run --cases N --seed S --out FILE.jsonl`.

Valves of a plant that was written from the published vocabulary and interface alone are recorded as CSV, the program
diagnoses the files, and its answers are held against the labels. One JSON line a case, as soon as it is there; a run
that was stopped goes on where it was. The summary is printed at the end.
"""

from __future__ import annotations

import argparse
import json
import os
import tempfile
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy: processes run side by side

from bench.stranger.draw import KINDS, draw_case
from bench.stranger.score import score
from bench.stranger.sizes import size_covered
from bench.stranger.summary import summary
from bench.stranger.tool import closure, diagnosed

_KEPT = ("verdict", "causes", "confusable", "ranking", "gap", "data_quality")


def one_case(seed: int, kind: str | None, rough: bool, index: int) -> dict[str, Any]:
    """Draws, records, diagnoses and scores one case. An error of the program is an answer too."""
    case = draw_case(seed, index, kind, rough)
    line: dict[str, Any] = {"case": index, "seed": seed, "label": case.label()}
    with tempfile.TemporaryDirectory(prefix="stranger-") as name:
        folder = Path(name)
        try:
            answer, seconds = diagnosed(case, folder)
            line |= {"answer": {key: answer[key] for key in _KEPT}, "seconds": round(seconds, 2)}
            line |= score(line["label"], answer)
            line["size_covered"] = size_covered(line["label"], answer)
            line["closure"] = closure(case, folder, case.noise)
        except Exception as error:
            line["error"] = f"{type(error).__name__}: {error}"
    return line


def _lines(todo: list[int], options: argparse.Namespace) -> Iterator[dict[str, Any]]:
    work = partial(one_case, options.seed, options.kind, options.rough)
    if options.processes == 1:
        yield from map(work, todo)
        return
    with ProcessPoolExecutor(options.processes, mp_context=get_context("spawn")) as pool:
        for done in as_completed([pool.submit(work, index) for index in todo]):
            yield done.result()


def _known(out: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in out.read_text(encoding="utf-8").splitlines()] if out.exists() else []


def main() -> None:
    """Runs the missing cases and prints the summary of all."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--cases", type=int, required=True)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--kind", choices=list(KINDS))
    parser.add_argument("--rough", action="store_true", help="polling jitter and a wandering pressure")
    parser.add_argument("--out", type=Path, required=True)
    options = parser.parse_args()
    options.out.parent.mkdir(parents=True, exist_ok=True)
    known = _known(options.out)
    done = {line["case"] for line in known}
    with options.out.open("a", encoding="utf-8") as file:
        for line in _lines([k for k in range(options.cases) if k not in done], options):
            known.append(line)
            file.write(json.dumps(line) + "\n")
            file.flush()
    print(summary(sorted(known, key=lambda line: int(line["case"]))))


if __name__ == "__main__":
    main()
