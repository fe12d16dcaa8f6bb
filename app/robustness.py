"""Measures margins of controllers on virtual valves, in as many processes as asked for."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from control.robustness import AXES, Margin, Nominal, Plant, Subject, first_swing, nominal, scan

if TYPE_CHECKING:
    from control.trial import Opened

LINEAR = ("p", "p_incremental", "pi", "pi_antiwindup")
FACTORS = tuple(round(1.1**n, 2) for n in range(1, 18))
LASTING = {"lasting_gain": FACTORS, "lasting_dead_time": AXES["dead_time"].values, "lasting_late": AXES["late"].values}
LASTING_S = 600.0


@dataclass(frozen=True, slots=True)
class Job:
    """One question about one controller: "nominal", one of `LASTING`, or one of `AXES`; plain values, so that it can go
    to another process."""

    subject: Subject
    kind: str
    plant: Plant
    seeds: tuple[int, ...]


def jobs(subjects: Sequence[Subject], plant: Plant, seeds: int, everything: bool) -> list[Job]:
    """What has to be asked: how they do as designed; for the linear laws what frequency analysis predicts; with
    `everything`, every axis for every controller."""
    found = []
    for subject in subjects:
        linear = tuple(LASTING) if subject.name in LINEAR else ()
        kinds = ("nominal", *linear, *(AXES if everything else ()))
        found += [Job(subject, kind, plant, tuple(range(seeds))) for kind in kinds]
    return found


def open_plant(plant: Plant, seed: int) -> Opened:
    """A fresh virtual valve with a plant's numbers, without a wire."""
    from app.hunting import plant_numbers
    from app.physics_bench import open_virtual
    from control.late_gauge import with_late_gauge

    effects = {"dead_time": plant.dead_time_s}
    return with_late_gauge(open_virtual(seed, numbers=plant_numbers(plant.design), effects=effects), plant.late_s)


def run(job: Job) -> Nominal | Margin:
    """The answer to one job."""
    if job.kind == "nominal":
        return nominal(job.subject, job.plant, job.seeds, open_plant)
    if job.kind in LASTING:
        return lasting(job)
    return scan(job.subject, AXES[job.kind], job.plant, job.seeds, open_plant)


def lasting(job: Job) -> Margin:
    """Where a swing begins to last under the conditions of `analyse`: what the describing function predicts, measured.

    Anti-windup does nothing there, because the command's ends are out of reach.
    """
    from app.hunting import measured
    from control.analysis.loop import LinearLoop

    subject, plant = job.subject, job.plant
    law: Any = subject.name.removesuffix("_antiwindup")
    kp, ki, d = subject.settings["kp"], subject.settings.get("ki", 0.0), subject.design
    base = LinearLoop(law, kp, ki, d.ep_tau_s, d.tau_s, plant.dead_time_s, subject.tick_s, plant.late_s)

    def swing(value: float) -> float:
        changed = {
            "lasting_gain": replace(base, kp=value * kp, ki=value * ki),
            "lasting_dead_time": replace(base, dead_time_s=base.dead_time_s + value),
            "lasting_late": replace(base, late_s=base.late_s + value),
        }[job.kind]
        found = measured(changed, d, LASTING_S)
        return 200.0 * found.stem_in / d.travel if found else 0.0

    return first_swing(LASTING[job.kind], swing)


def run_all(todo: Sequence[Job], processes: int) -> Iterator[Nominal | Margin]:
    """The answers, in the order of the jobs."""
    from app.processes import in_order

    return in_order(run, todo, processes)
