"""All controllers over all scenarios and seeds: the table behind `lostmotion compare`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace

import numpy as np

from control.controller import make_controller
from control.design import DesignModel
from control.held_out import held_out
from control.metrics import Score, score
from control.scenarios import SCENARIOS, Scenario
from control.trial import Opened, Trace, run_trial

BenchFactory = Callable[[Scenario, int], Opened]
NUMBERS = {"a1": "a1", "a2": "a2", "compliance": "compliance", "tau": "tau_s", "rate_limit": "rate_limit"}


@dataclass(frozen=True, slots=True)
class Job:
    """One trial to be run; plain values, so that it can go to another process."""

    controller: str
    scenario: str
    seed: int
    period_s: float
    design: DesignModel
    held_out: bool = False

    @property
    def asked(self) -> Scenario:
        """The scenario as it is played."""
        scenario = SCENARIOS[self.scenario]
        return held_out(scenario, self.seed) if self.held_out else scenario


@dataclass(frozen=True, slots=True)
class Result:
    """A trial's score."""

    job: Job
    score: Score


def jobs(
    controllers: Iterable[str],
    scenarios: Iterable[str],
    seeds: Iterable[int],
    period_s: float,
    design: DesignModel,
    held_out: bool = False,
) -> list[Job]:
    """Every combination."""
    names, numbers = list(scenarios), list(seeds)
    return [Job(c, s, seed, period_s, design, held_out) for c in controllers for s in names for seed in numbers]


def play(job: Job, open_bench: BenchFactory) -> Trace:
    """Runs a job's trial."""
    scenario, controller = job.asked, make_controller(job.controller, job.design)
    return run_trial(open_bench(scenario, job.seed), controller, scenario.targets(job.period_s), job.period_s)


def run_job(job: Job, open_bench: BenchFactory) -> Result:
    """Runs a job's trial and scores it."""
    scenario = job.asked
    return Result(job, score(play(job, open_bench), scenario, true_valve(scenario)))


def true_valve(scenario: Scenario) -> DesignModel:
    """The numbers of the scenario's valve as its gauge shows it: the thesis's, with the scenario's replaced."""
    changed = {NUMBERS[name]: value for name, value in scenario.numbers.items() if name in NUMBERS}
    valve: DesignModel = replace(DesignModel(), **changed)  # type: ignore[arg-type]
    gain = scenario.reading_gain
    return replace(
        valve, compliance=gain * valve.compliance, rate_limit=gain * valve.rate_limit, travel=gain * valve.travel
    )


def summary(results: Sequence[Result]) -> dict[str, dict[str, float]]:
    """Per controller: the worst and the median over scenarios and seeds, and the spread over seeds."""
    table = {}
    for name in dict.fromkeys(r.job.controller for r in results):
        mine = [r for r in results if r.job.controller == name]
        scores = [r.score for r in mine]
        table[name] = {
            "steady_worst": max(s.steady for s in scores),
            "later_worst": max(s.later for s in scores),
            "later_median": _median(s.later for s in scores),
            "steady_median": _median(s.steady for s in scores),
            "steady_spread": _seed_spread(mine),
            "peak_worst": max(s.peak for s in scores),
            "settling_s": _median(s.settling_s for s in scores),
            "ratio": _median(s.ratio for s in scores),
            "close": float(np.mean([s.close for s in scores])),
            "unsettled": float(np.mean([s.unsettled for s in scores])),
            "overshoot": max(s.overshoot for s in scores),
            "limit_cycles": float(np.mean([s.cycle > 0.0 for s in scores])),
            "cycle_worst": max(s.cycle for s in scores),
            "stem_in": float(np.mean([s.stem_in for s in scores])),
            "air_psi": float(np.mean([s.air_psi for s in scores])),
        }
    return table


def by_scenario(results: Sequence[Result], key: str) -> dict[str, dict[str, tuple[float, float]]]:
    """controller -> scenario -> (median, spread over seeds) of one number of the score."""
    table: dict[str, dict[str, list[float]]] = {}
    for r in results:
        table.setdefault(r.job.controller, {}).setdefault(r.job.scenario, []).append(getattr(r.score, key))
    return {c: {s: (float(np.nanmedian(v)), float(np.ptp(v))) for s, v in row.items()} for c, row in table.items()}


def as_json(results: Sequence[Result]) -> dict[str, object]:
    """Everything, for scripts; numbers that are not finite become null."""

    def plain(values: Mapping[str, float]) -> dict[str, float | None]:
        return {name: (float(value) if np.isfinite(value) else None) for name, value in values.items()}

    trials = [
        {
            "controller": r.job.controller,
            "scenario": r.job.scenario,
            "seed": r.job.seed,
            "held_out": r.job.held_out,
            **plain(asdict(r.score)),
        }
        for r in results
    ]
    return {"summary": {name: plain(row) for name, row in summary(results).items()}, "trials": trials}


def _median(values: Iterable[float]) -> float:
    finite = [v for v in values if np.isfinite(v)]
    return float(np.median(finite)) if finite else float("nan")


def _seed_spread(results: Sequence[Result]) -> float:
    groups: dict[str, list[float]] = {}
    for r in results:
        groups.setdefault(r.job.scenario, []).append(r.score.steady)
    return float(np.mean([np.ptp(v) for v in groups.values()]))
