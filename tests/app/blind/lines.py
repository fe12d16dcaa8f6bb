"""Labels, diagnoses and result lines made by hand."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from app.blind.mark import mark
from app.blind.strength import stratum
from sim_device.sealed import Cause, Label

STAGES = {"dead_time": "ep", "creep": "actuator", "stiction": "actuator", "sensor_lag": "sensor"}


def label(kind: str, *names: str, family: str = "thesis") -> Label:
    causes = tuple(Cause(name, STAGES.get(name, "actuator"), "default", 0.5, "s", "medium") for name in names)
    return Label(kind, family, 1, causes)


def said(verdict: str, *named: tuple[str, float], confusable: tuple[tuple[str, ...], ...] = ()) -> dict[str, Any]:
    """A diagnosis that names causes with probabilities; the ranking holds them and one bystander."""
    causes = [
        {"name": name, "stage": STAGES.get(name, "actuator"), "probability": p, "parameters": {}} for name, p in named
    ]
    ranking = [{"name": name, "probability": p} for name, p in (*named, ("flow_force", 0.01))]
    stage = {"ep": 0.8, "actuator_or_sensor": 0.2, "ci95": {}}
    gap = {"before": 2.0, "after": 0.2, "noise_floor": 0.1}
    return {
        "verdict": verdict,
        "causes": causes,
        "confusable": confusable,
        "ranking": ranking,
        "where": {"stage": stage},
        "gap": gap,
    }


def line(number: int, truth: Label, answer: dict[str, Any], ratio: float, closed: float | None = 0.9) -> dict[str, Any]:
    """A line as a trial writes it."""
    ratio = ratio if truth.causes else 0.0
    return {
        "trial": number,
        "seal": f"blind-1-{number}",
        "commitment": f"{number:064x}",
        "label": asdict(truth),
        "ratio": ratio,
        "weakest": ratio,
        "stratum": stratum(ratio),
        **{key: answer[key] for key in ("verdict", "causes", "confusable", "ranking", "gap")},
        "where_stage": answer["where"]["stage"],
        "mark": asdict(mark(truth, answer)),
        "sizes": [],
        "closed_loop": {"before": 2.0, "after": 0.5, "floor": 0.1, "closed": closed if truth.causes else None},
        "rows": 100,
        "seconds": {"record": 1.0, "diagnose": 2.0},
    }


def some_lines() -> list[dict[str, Any]]:
    """Eight trials: six that count, one below the floor, one that broke."""
    creep = ("creep", 0.9)
    return [
        line(0, label("none"), said("no_gap"), 0.0),
        line(1, label("none"), said("effect", creep), 0.0),
        line(2, label("effect", "creep"), said("effect", creep), 5.0),
        line(3, label("effect", "dead_time"), said("effect", ("sensor_lag", 0.6)), 20.0, closed=0.5),
        line(4, label("effects", "creep", "dead_time"), said("effect", creep), 12.0),
        line(5, label("outsider", "snap_region"), said("unexplained"), 4.0, closed=None),
        line(6, label("effect", "creep"), said("no_gap"), 0.5),
        {"trial": 7, "seal": "blind-1-7", "error": "WireFault: no reply"},
    ]
