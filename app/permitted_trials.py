"""What `docs/controllers.md` says the bench permits: held-out trials played by the oracle, and their block."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from app.interval import share
from app.marked_block import with_block
from control.compare import Job, jobs, true_valve
from control.design import DesignModel
from control.metrics import GOAL_PERCENT, Score, score
from control.scenarios import SCENARIOS

BEGIN, END = "<!-- made by bench/permitted_trials.py: begin -->", "<!-- end -->"
KEPT = ("steady", "cycle")
FILE, PAGE = "permitted-trials.json", "controllers.md"
HEAD = ("scenario", "trials within 0.3 %", "median steady error [%]", "worst [%]", "trials with a limit cycle")
PERIOD_S = 0.1
Stored = Mapping[str, Any]


def play(job: Job) -> Score:
    """A job's trial with the oracle as its controller, scored as any other."""
    from app.oracle.oracle import Oracle
    from app.rivals import open_scenario
    from control.trial import run_trial

    asked = job.asked
    opened = open_scenario(asked, job.seed)
    trace = run_trial(opened, Oracle(asked), asked.targets(job.period_s), job.period_s)
    return score(trace, asked, true_valve(asked))


def run(seeds: Sequence[int]) -> Stored:
    """The oracle through every scenario, drawn anew for each seed: scenario -> score -> one number per seed."""
    table: dict[str, dict[str, list[float]]] = {name: {key: [] for key in KEPT} for name in SCENARIOS}
    for job in jobs(["oracle"], SCENARIOS, seeds, PERIOD_S, DesignModel(), held_out=True):
        found = play(job)
        for key in KEPT:
            table[job.scenario][key].append(round(float(getattr(found, key)), 4))
    return {"first_seed": seeds[0], "seeds": len(seeds), "trials": table}


def block(stored: Stored) -> str:
    """The table, and what it comes to."""
    first, n, trials = stored["first_seed"], stored["seeds"], stored["trials"]
    steady, cycle = ([value for mine in trials.values() for value in mine[key]] for key in KEPT)
    near, still = share([value <= GOAL_PERCENT for value in steady], 1), share([value == 0.0 for value in cycle], 1)
    return "\n".join(
        (
            f"`python bench/permitted_trials.py {first} {n}`, {n * len(trials)} trials of the oracle:",
            "",
            f"| {' | '.join(HEAD)} |",
            "|---|" + "---:|" * (len(HEAD) - 1),
            *(_row(name, mine["steady"], mine["cycle"]) for name, mine in trials.items()),
            _row("**all**", steady, cycle),
            "",
            f"Together, with 95 % intervals (Wilson's): {near} of trials within {GOAL_PERCENT} %, {still} without a "
            "limit cycle.",
        )
    )


def _row(name: str, steady: Sequence[float], cycle: Sequence[float]) -> str:
    near, swings = sum(value <= GOAL_PERCENT for value in steady), sum(value > 0.0 for value in cycle)
    n = len(steady)
    return f"| {name} | {near}/{n} | {np.median(steady):.2f} | {max(steady):.2f} | {swings}/{n} |"


def load(folder: Path) -> Stored:
    """The stored trials."""
    found: Stored = json.loads((folder / FILE).read_text(encoding="utf-8"))
    return found


def write(folder: Path, stored: Stored) -> None:
    """Stores the trials and puts the block into the page."""
    (folder / FILE).write_text(json.dumps(stored) + "\n", encoding="utf-8")
    page = (folder / PAGE).read_text(encoding="utf-8")
    (folder / PAGE).write_text(with_block(page, BEGIN, block(stored), END), encoding="utf-8")
