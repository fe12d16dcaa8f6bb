"""Open-loop records of the virtual valve, each with the command that makes the same one over Modbus."""

from __future__ import annotations

import json
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from control.design import DesignModel
from control.experiment_catalog import make_experiment
from logs.recording import FloatArray, Recording
from sim_device.physics.catalog import make_physics
from sim_device.physics.offline import record

if TYPE_CHECKING:
    from control.identify_result import Identified

TRAINING_SEED = 1
SEEDS = range(2, 22)  # of records that the model has not seen
PLAIN: Mapping[str, object] = {"conditioning": False}


@dataclass(frozen=True, slots=True)
class Sweep:
    """An experiment on a fresh virtual valve, as `lostmotion sweep KIND --physics PHYSICS` does it."""

    kind: str
    settings: Mapping[str, object] = field(default_factory=dict)
    physics: str = "thesis"
    plant: Mapping[str, float] = field(default_factory=dict)

    def record(self, seed: int = TRAINING_SEED) -> Recording:
        """Its record without the wire, for speed; commands in psi, or percent for the positioner."""
        unit = "percent" if self.physics == "positioner" else "psi"
        plan = make_experiment(self.kind, {"unit": unit, "seed": seed, **PLAIN, **self.settings})
        schedule = plan.commands()
        # A command goes out after the readings of its tick and is in force when the next row is read.
        command = np.concatenate(([0.0], schedule.command[:-1]))
        pressure, position = record(make_physics(self.physics, seed, **self.plant), schedule.time_s, command)
        return Recording(self.kind, schedule.time_s, command, position, pressure)

    def command(self, seed: int = TRAINING_SEED, out: str = "") -> str:
        """What to type for the same over Modbus."""
        words = ["lostmotion", "sweep", self.kind, *([] if self.physics == "thesis" else ["--physics", self.physics])]
        for name, number in self.plant.items():
            words += ["--plant", f"{name}={number:g}"]
        for key, value in {**PLAIN, **self.settings}.items():
            words += ["--set", f"{key}={_short(value)}"]
        return shlex.join([*words, "--seed", str(seed), *(["--out", out] if out else [])])


def _short(value: object) -> str:
    """A value as on a command line: 5 for 5.0, lists without blanks."""
    if isinstance(value, Sequence) and not isinstance(value, str):
        return f"[{','.join(map(_short, value))}]"
    return f"{value:.6g}" if isinstance(value, float) else json.dumps(value)


# The conditioning stroke before it shows the rate limit, which steps of 0.2 psi do not reach.
STAIRCASE = Sweep("staircase", {"low": 5.0, "high": 12.2, "step": 0.2, "dwell_s": 20.0, "conditioning": True})
IDENTIFY = f"{STAIRCASE.command(out='RUN')} && lostmotion identify RUN --out MODEL.toml"


@cache
def identified() -> Identified:
    """What one record, the staircase of figure 1-6, gives; its model is tested in figures 2-4, 2-5 and 2-7."""
    from control.identify import identify

    return identify([STAIRCASE.record()])


def on_unseen(sweep: Sweep, seed: int) -> str:
    """The commands that identify the model and hold it against a record that it has not seen."""
    simulate = "lostmotion simulate MODEL.toml OTHER --out FILE.csv --plot FILE.png"
    return f"{IDENTIFY} && {sweep.command(seed, 'OTHER')} && {simulate}"


def simulated(recording: Recording, design: DesignModel) -> FloatArray:
    """The model's stem for the commands of a record, as `lostmotion simulate` computes it [in]."""
    from twin.model.insert import plant_of
    from twin.replay.simulate import simulate_recording

    return simulate_recording(plant_of(design), recording)[1]


def settled(recording: Recording, hold_s: float, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Command, and mean of `values` over the last quarter, of every hold."""
    n = round(hold_s / recording.time_s[1])
    rows = values[: recording.n // n * n].reshape(-1, n)
    return recording.command[: rows.size].reshape(-1, n)[:, -1], np.asarray(rows[:, -n // 4 :].mean(axis=1))


def typical(values: Mapping[int, float]) -> int:
    """The key whose value is nearest the median: the record to show, neither the best nor the worst.

    Of an even number two are equally near; which one must not hang on the last bits of a machine: the lower key.
    """
    middle = float(np.median(list(values.values())))
    tie = 1e-9 * max(abs(middle), 1e-300)
    return min(values, key=lambda key: (round(abs(values[key] - middle) / tie), key))
