"""What `docs/controllers.md` says of `brake` on held-out draws: stored trials, and the block that is made of them."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from app.interval import share
from app.marked_block import with_block
from control.compare import Result, jobs
from control.design import DesignModel
from control.metrics import GOAL_PERCENT
from control.scenarios import SCENARIOS

BEGIN, END = "<!-- made by bench/held_out.py: begin -->", "<!-- end -->"
KEPT = ("steady", "cycle", "settling_s", "ratio", "close", "overshoot", "stem_in", "air_psi")
FILE, PAGE = "held-out.json", "controllers.md"
Stored = Mapping[str, Any]
HEAD = (
    "scenario",
    "trials within 0.3 %",
    "median steady error [%]",
    "worst [%]",
    "trials with a limit cycle",
    "settling [s]",
    "over the minimum",
    "steps within 1.2 [%]",
    "overshoot [%]",
    "stem [in]",
    "air [psi]",
)


def run(seeds: Sequence[int], drawn: bool, processes: int) -> Stored:
    """Plays `brake` through every scenario; `drawn`: sizes and targets drawn anew for each seed."""
    from app.rivals import run_all

    todo = jobs(["brake"], SCENARIOS, seeds, 0.1, DesignModel(), held_out=drawn)
    return stored(list(run_all(todo, processes)), seeds)


def stored(results: Sequence[Result], seeds: Sequence[int]) -> Stored:
    """Scenario -> score -> one number per seed; null where it is not finite."""
    table: dict[str, dict[str, list[float | None]]] = {}
    for r in results:
        mine = table.setdefault(r.job.scenario, {key: [] for key in KEPT})
        for key in KEPT:
            value = float(getattr(r.score, key))
            mine[key].append(round(value, 4) if math.isfinite(value) else None)
    return {"first_seed": seeds[0], "seeds": len(seeds), "trials": table}


def block(drawn: Stored, named: Stored) -> str:
    """The table, and what it comes to; and the scenarios as they are named."""
    n, trials = drawn["seeds"], drawn["trials"]
    rows = [_row(name, [trials[name]]) for name in trials] + [_row("**all**", list(trials.values()))]
    command = f"lostmotion compare -c brake --held-out --first-seed {drawn['first_seed']} --seeds {n}"
    return "\n".join(
        (
            f"`{command}`, {n * len(trials)} trials:",
            "",
            f"| {' | '.join(HEAD)} |",
            "|---|" + "---:|" * (len(HEAD) - 1),
            *rows,
            "",
            f"Together, with 95 % intervals (Wilson's): {_goal(drawn)}. The thesis ends at 1.3 %.",
            "",
            "With everything wrong at its full named size instead of a half to all of it (`lostmotion compare -c brake "
            f"--seeds {named['seeds']}`), on seeds on which it was tuned: {_goal(named)}.",
        )
    )


def _all(parts: Sequence[Mapping[str, Sequence[float | None]]], key: str) -> list[float]:
    return [value for part in parts for value in part[key] if value is not None]


def _row(name: str, parts: Sequence[Mapping[str, Sequence[float | None]]]) -> str:
    steady, cycle = _all(parts, "steady"), _all(parts, "cycle")
    cells = (
        f"{sum(value <= GOAL_PERCENT for value in steady)}/{len(steady)}",
        f"{np.median(steady):.2f}",
        f"{max(steady):.2f}",
        f"{sum(value > 0.0 for value in cycle)}/{len(cycle)}",
        f"{np.median(_all(parts, 'settling_s')):.1f}",
        f"{np.median(_all(parts, 'ratio')):.2f}",
        f"{100.0 * np.mean(_all(parts, 'close')):.0f}",
        f"{max(_all(parts, 'overshoot')):.1f}",
        f"{np.mean(_all(parts, 'stem_in')):.1f}",
        f"{np.mean(_all(parts, 'air_psi')):.0f}",
    )
    return f"| {name} | {' | '.join(cells)} |"


def _goal(found: Stored) -> str:
    parts = list(found["trials"].values())
    steady, cycle, close = (_all(parts, key) for key in ("steady", "cycle", "close"))
    near, still = share([value <= GOAL_PERCENT for value in steady], 1), share([value == 0.0 for value in cycle], 1)
    return (
        f"{near} of trials within {GOAL_PERCENT} %, the worst {max(steady):.2f} %; {still} without a limit cycle; "
        f"{100.0 * np.mean(close):.0f} % of steps within 1.2 times the minimum, the median step at "
        f"{np.median(_all(parts, 'ratio')):.2f} times"
    )


def load(folder: Path) -> tuple[Stored, Stored]:
    """The stored trials: drawn, and as named."""
    found = json.loads((folder / FILE).read_text(encoding="utf-8"))
    return found["drawn"], found["named"]


def write(folder: Path, drawn: Stored, named: Stored) -> None:
    """Stores the trials and puts the block into the page."""
    (folder / FILE).write_text(json.dumps({"drawn": drawn, "named": named}) + "\n", encoding="utf-8")
    page = (folder / PAGE).read_text(encoding="utf-8")
    (folder / PAGE).write_text(with_block(page, BEGIN, block(drawn, named), END), encoding="utf-8")
