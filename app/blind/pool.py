"""Many trials in a few processes, one JSON line each as soon as it is done; stopped at any time and gone on with."""

from __future__ import annotations

import json
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any

from app.blind.trial import Order, run_trial
from app.processes import workers
from hal.errors import BadInput

Line = dict[str, Any]
RESULTS = "trials.jsonl"


def read_lines(out: Path) -> list[Line]:
    """The results that are there, by trial number; a line cut off by a crash is left out and its trial redone.

    Raises: `BadInput` when a line in the middle of the file is damaged.
    """
    path = out / RESULTS
    if not path.exists():
        return []
    lines: dict[int, Line] = {}
    texts = path.read_text(encoding="utf-8").splitlines()
    for row, text in enumerate(texts, start=1):
        try:
            line = json.loads(text)
            lines[line["trial"]] = line
        except (ValueError, KeyError, TypeError) as error:
            if row < len(texts):
                raise BadInput(
                    f"{path}: line {row} is no trial ({error}); remove it and that trial is redone"
                ) from None
    return [lines[number] for number in sorted(lines)]


def run_all(
    todo: Sequence[Order], out: Path, processes: int = 2, trial: Callable[[Order], Line] = run_trial
) -> Generator[Line, None, None]:
    """Runs the trials, appends every result to OUT/trials.jsonl and yields it. Leave it early and the workers end.

    A trial that fails is a result with an `error`, because what breaks the program is a finding about it too.
    """
    _cut_last_line(out / RESULTS)
    with (out / RESULTS).open("a", encoding="utf-8") as file, workers(processes) as pool:
        jobs = {pool.submit(trial, order): order for order in todo}
        for line in _finished(jobs):
            file.write(json.dumps(line) + "\n")
            file.flush()
            yield line


def _finished(jobs: dict[Future[Line], Order]) -> Iterator[Line]:
    left = set(jobs)
    while left:
        done, left = wait(left, return_when=FIRST_COMPLETED)
        for job in done:
            error = job.exception()
            if error is None:
                yield job.result()
            elif isinstance(error, BrokenProcessPool) or not isinstance(error, Exception):
                raise error  # a worker is gone, or Ctrl-C reached it first
            else:
                yield {"trial": jobs[job].number, "seal": jobs[job].seal, "error": f"{type(error).__name__}: {error}"}


def _cut_last_line(path: Path) -> None:
    """Takes away a line that a crash cut off, so that the next result starts on its own."""
    if path.exists():
        whole = path.read_bytes()
        end = whole.rfind(b"\n") + 1
        if end < len(whole):
            with path.open("r+b") as file:
                file.truncate(end)
