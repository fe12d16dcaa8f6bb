"""Runs comparison jobs on virtual valves, in as many processes as asked for."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from control.compare import Job, Result
    from control.scenarios import Scenario
    from control.trial import Opened


def open_scenario(scenario: Scenario, seed: int) -> Opened:
    """The scenario's valve, fresh, without a wire."""
    from app.physics_bench import open_virtual

    return open_virtual(seed, numbers=scenario.numbers, effects=scenario.effects, noise=scenario.noise)


def run(job: Job) -> Result:
    """One job."""
    from control.compare import run_job

    return run_job(job, open_scenario)


def run_all(jobs: Sequence[Job], processes: int) -> Iterator[Result]:
    """The results, in the order of the jobs. Every job has its own seed, so the number of processes changes nothing."""
    from app.processes import in_order

    return in_order(run, jobs, processes)
