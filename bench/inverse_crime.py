"""The inverse crime, for contrast: `python bench/inverse_crime.py --cases N --seed S --out FILE.jsonl`.

Faults are simulated with the candidates' own code, forms and starts, and white noise is added. What the diagnosis
scores here is a unit test of the search; published beside the blind check it shows how much such figures flatter.
"""

from __future__ import annotations

import argparse
import json
import os
import random
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, replace
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

from app.blind.calibration import error
from app.blind.excite import PERIOD_S, commands, open_loop
from app.blind.mark import mark
from app.interval import wilson
from control.design import DesignModel
from logs.recording import Recording
from sim_device.sealed import Cause, Label
from twin.diagnose import Settings, diagnose
from twin.fit.channel import predict_reading, pressure_fine
from twin.fit.numbers import NUMBERS, nominal, retuned
from twin.fit.trial import make_trial
from twin.model.catalog import effects
from twin.model.effect import Scales
from twin.model.plant import Inserted, Plant
from twin.search.search_rules import SearchRules

SHARES = {"effect": 0.6, "parameter": 0.2, "none": 0.2}
POSITION_IN, PRESSURE_PSI = 6e-4, 4e-3
_FINE_S = 0.05
_FACTORS = (0.7, 1.4)  # sizes about a form's own starts
_OFF = (0.05, 0.25)  # how far off a wrong number is, as a share of it


def drawn(number: int, seed: int) -> tuple[Label, Plant]:
    """The case of a number: its label and the plant that has the fault."""
    dice = random.Random(f"crime|{seed}|{number}")
    kind = dice.choices(list(SHARES), list(SHARES.values()))[0]
    if kind == "effect":
        effect = dice.choice([e for e in effects().values() if e.forms])
        form = dice.choice(effect.forms)
        factor = dice.uniform(*_FACTORS)
        values = tuple(dice.choice(p.starts) * (factor if p.size else 1.0) for p in form.parameters)
        clipped = tuple(min(max(v, p.lower), p.upper) for v, p in zip(values, form.parameters, strict=True))
        inserted = Inserted(
            effect.name, form, tuple(v * Scales().factor(p.kind) for v, p in zip(clipped, form.parameters, strict=True))
        )
        return _label(kind, number, effect.name, effect.stage, form.name, clipped[0]), Plant(DesignModel(), (inserted,))
    if kind == "parameter":
        name = dice.choice(list(NUMBERS))
        size = dice.uniform(*_OFF) * dice.choice((-1.0, 1.0)) * (0.15 if name == "offset" else 1.0)
        design = retuned(DesignModel(), {name: nominal(DesignModel(), name) * (1.0 + size)})
        return _label(kind, number, f"parameter:{name}", NUMBERS[name], "default", size), Plant(design)
    return Label("none", "crime", number, ()), Plant(DesignModel())


def _label(kind: str, number: int, name: str, stage: str, form: str, size: float) -> Label:
    return Label(kind, "crime", number, (Cause(name, stage, form, float(f"{size:.4g}"), "", ""),))


def recorded(plant: Plant, number: int) -> tuple[Recording, float]:
    """What the plant's own equations say to the test sequence, with white noise; and the RMS of the fault [in]."""
    time_s, command = commands(open_loop(number))
    blank = Recording(f"crime-{number}", time_s, command, np.zeros(time_s.size), np.zeros(time_s.size))
    blank = replace(blank, pressure=np.full(time_s.size, command[0]))
    trial = make_trial(blank, min(_FINE_S, PERIOD_S))
    dice = np.random.default_rng(number)
    true = predict_reading(plant, trial)
    away = float(np.sqrt(np.mean((true - predict_reading(Plant(DesignModel()), trial)) ** 2)))
    pressure = pressure_fine(plant, trial)[trial.grid.offsets] + dice.normal(0.0, PRESSURE_PSI, time_s.size)
    return replace(blank, pressure=pressure, position=true + dice.normal(0.0, POSITION_IN, time_s.size)), away


def solve(number: int, seed: int) -> dict[str, Any]:
    """One case, from the draw to the mark."""
    label, plant = drawn(number, seed)
    recording, away_in = recorded(plant, number)
    said = diagnose([recording], DesignModel(), (), Settings(search=SearchRules(threads=1))).diagnosis.to_json()
    marked = asdict(mark(label, said))
    return {
        "case": number,
        "label": asdict(label),
        "ratio": away_in / POSITION_IN,
        "mark": marked,
        "causes": said["causes"],
    }


def table_rows(lines: list[dict[str, Any]]) -> Iterator[list[str]]:
    """What, figure and interval, of the faults above the noise."""
    seen = [li for li in lines if li["label"]["kind"] == "none" or li["ratio"] >= 1.0]
    for what, kinds in (("all right", tuple(SHARES)), *((f"all right: {kind}", (kind,)) for kind in SHARES)):
        yield _rate(what, [li["mark"]["right"] for li in seen if li["label"]["kind"] in kinds])
    yield _rate("first named cause is true", [li["mark"]["leading"] for li in seen if li["label"]["kind"] != "none"])
    yield ["expected calibration error", f"{error([tuple(c) for li in lines for c in li['mark']['claims']]):.3f}", ""]


def _rate(what: str, marks: list[bool]) -> list[str]:
    low, high = wilson(sum(marks), len(marks))
    return [what, f"{sum(marks)} of {len(marks)}", f"{100.0 * low:.0f} to {100.0 * high:.0f} %"]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--processes", type=int, default=2)
    asked = parser.parse_args()
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    with (
        asked.out.open("w", encoding="utf-8") as file,
        ProcessPoolExecutor(asked.processes, get_context("spawn")) as pool,
    ):
        lines = []
        for line in pool.map(solve, range(asked.cases), [asked.seed] * asked.cases):
            lines.append(line)
            file.write(json.dumps(line) + "\n")
            names = [c["name"] for c in line["label"]["causes"]], [c["name"] for c in line["causes"]]
            print(
                f"{len(lines)}/{asked.cases} {'right' if line['mark']['right'] else 'WRONG'} {names[0]} -> {names[1]}",
                flush=True,
            )
    for cells in table_rows(lines):
        print("".join(f"{cell:34}" for cell in cells).rstrip())


if __name__ == "__main__":
    main()
