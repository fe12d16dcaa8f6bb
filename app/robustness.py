"""Measures margins of controllers on virtual valves, in as many processes as asked for."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from control.robustness import AXES, Margin, Nominal, Plant, Subject, nominal, scan

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
    from control.late_gauge import LateGauge

    effects = {"dead_time": plant.dead_time_s} if plant.dead_time_s else {}
    opened = open_virtual(seed, numbers=plant_numbers(plant.design), effects=effects)
    return replace(opened, bench=LateGauge(opened.bench, plant.late_s)) if plant.late_s else opened


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

    d, settings = job.subject.design, job.subject.settings
    law: Any = job.subject.name.removesuffix("_antiwindup")
    base = LinearLoop(law, settings["kp"], settings.get("ki", 0.0), d.ep_tau_s, d.tau_s, job.plant.dead_time_s)
    base = replace(base, tick_s=job.subject.tick_s)
    good = None
    for value in LASTING[job.kind]:
        changed = {
            "lasting_gain": replace(base, kp=value * base.kp, ki=value * base.ki),
            "lasting_dead_time": replace(base, dead_time_s=base.dead_time_s + value),
            "lasting_late": replace(base, late_s=value),
        }[job.kind]
        found = measured(changed, d, LASTING_S)
        if found is not None:
            return Margin(good, value, 200.0 * found.stem_in / d.travel)
        good = value
    return Margin(good, None)


def run_all(todo: Sequence[Job], processes: int) -> Iterator[Nominal | Margin]:
    """The answers, in the order of the jobs."""
    from app.processes import in_order

    return in_order(run, todo, processes)
