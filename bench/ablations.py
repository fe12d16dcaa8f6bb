"""What the diagnosis loses when something is taken from it: `python bench/ablations.py --cases N --seed S --out DIR`.

The same labelled valves of the thesis's family are diagnosed again and again: as in the blind check, without a repeat
(same bench time), without the pressure, on half the length, with a coarse position sensor, from closed-loop data alone,
and against a design that is off. Results go to DIR/NAME.jsonl and are gone on with; the table is printed at the end.

A coarse sensor and a design that is off are true causes of their own; naming them there is no fault.
"""

from __future__ import annotations

import argparse
import json
import os
import tempfile
from collections.abc import Callable, Mapping
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict, dataclass, field, replace
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

from app.blind.excite import PERIOD_S, TRAVEL_IN, commands, open_loop
from app.blind.mark import mark
from app.blind.strength import stratum, strength
from app.interval import wilson
from app.job import Job, perform
from app.session import open_bench
from bench.calibrate import labels
from control.controller import make_controller
from control.design import DesignModel
from control.drive import ControllerDrive
from control.plan import plan_targets
from logs.load import load_recording
from logs.recording import Recording
from sim_device.physics.catalog import make_physics
from sim_device.physics.offline import record
from sim_device.sealed import Label
from twin.diagnose import Settings, diagnose
from twin.search.search_rules import SearchRules

COARSE_IN = TRAVEL_IN / 256
OFF = DesignModel(compliance=0.205, a1=8.95, a2=5.80, tau_s=2.2, rate_limit=0.14)


@dataclass(frozen=True)
class Ablation:
    """How the record is made, what it is held against, and which names are forgiven where they are not the fault."""

    make: Callable[[Label], Recording]
    design: DesignModel = field(default_factory=DesignModel)
    forgiven: Callable[[str], bool] = lambda _name: False


def played(label: Label, repeats: int = 2, share: float = 1.0) -> Recording:
    """The test sequence, offline."""
    time_s, command = commands(open_loop(label.physics_seed, repeats, share))
    pressure, position = record(valve(label), time_s, command)
    return Recording("case", time_s, command, position, pressure)


def valve(label: Label) -> Any:
    return make_physics(label.family, label.physics_seed, effects={c.key: c.size for c in label.causes})


def coarse(label: Label) -> Recording:
    recording = played(label)
    return replace(recording, position=COARSE_IN * np.round(recording.position / COARSE_IN))


def closed_loop(label: Label) -> Recording:
    """A controller follows 36 positions, over Modbus; no open-loop stretch is in the record."""
    targets = np.random.default_rng(label.physics_seed).uniform(0.03, TRAVEL_IN - 0.03, 36)
    plan = plan_targets([float(x) for x in targets], 25.0, PERIOD_S, TRAVEL_IN)
    made = make_controller("if_then_pi", DesignModel())
    job = Job("run", plan, lambda begun: ControllerDrive(made, PERIOD_S, begun), closed_loop=True)
    faults = {cause.key: cause.size for cause in label.causes}
    with (
        tempfile.TemporaryDirectory() as folder,
        open_bench(physics=label.family, seed=label.physics_seed, options={"effects": faults}) as session,
    ):
        return load_recording(perform(session, job, out=Path(folder) / "run", live=False, title="").folder)


ABLATIONS: Mapping[str, Ablation] = {
    "as in the check": Ablation(played),
    "without a repeat": Ablation(lambda label: played(label, repeats=1, share=2.0)),
    "without pressure": Ablation(lambda label: replace(played(label), pressure=None)),
    "half the length": Ablation(lambda label: played(label, share=0.5)),
    "coarse sensor": Ablation(coarse, forgiven=lambda name: name == "sensor_quantization"),
    "closed loop only": Ablation(closed_loop),
    "misleading design": Ablation(played, OFF, forgiven=lambda name: name.startswith("parameter:")),
}


def solve(name: str, number: int, label: Label) -> dict[str, Any]:
    """One case under one ablation."""
    ablation = ABLATIONS[name]
    outcome = diagnose([ablation.make(label)], ablation.design, (), Settings(search=SearchRules(threads=1)))
    said = _forgiving(outcome.diagnosis.to_json(), label, ablation)
    ratio = strength(label, *commands(open_loop(label.physics_seed))).ratio
    kept = {key: said[key] for key in ("verdict", "causes", "confusable", "gap")}
    marked = asdict(mark(label, said))
    return {"case": number, "label": asdict(label), "ratio": ratio, "stratum": stratum(ratio), **kept, "mark": marked}


def _forgiving(said: dict[str, Any], label: Label, ablation: Ablation) -> dict[str, Any]:
    """The diagnosis without the causes that the ablation itself brought in."""
    true = {cause.name for cause in label.causes}
    causes = [c for c in said["causes"] if c["name"] in true or not ablation.forgiven(c["name"])]
    silent = not causes and said["verdict"] != "unexplained"
    return said | {"causes": causes, "verdict": "no_gap" if silent else said["verdict"]}


def run(name: str, cases: list[Label], folder: Path, processes: int) -> list[dict[str, Any]]:
    """All cases under one ablation, those that are there already left out."""
    path = folder / f"{name.replace(' ', '-')}.jsonl"
    lines = [json.loads(text) for text in path.read_text(encoding="utf-8").splitlines()] if path.exists() else []
    todo = [(k, label) for k, label in enumerate(cases) if k not in {line["case"] for line in lines}]
    with path.open("a", encoding="utf-8") as file, ProcessPoolExecutor(processes, get_context("spawn")) as pool:
        jobs = {pool.submit(solve, name, number, label): number for number, label in todo}
        for job in as_completed(jobs):
            error = job.exception()
            line = job.result() if error is None else {"case": jobs[job], "error": f"{type(error).__name__}: {error}"}
            file.write(json.dumps(line) + "\n")
            file.flush()
            lines.append(line)
    return [line for line in lines if line["case"] < len(cases)]


def row(name: str, lines: list[dict[str, Any]]) -> list[str]:
    """Its name, all right, first cause true, false cause on a healthy valve, and how many trials broke."""
    whole = [line for line in lines if "error" not in line]
    seen = [li for li in whole if li["label"]["kind"] == "none" or li["ratio"] >= 1.0]
    known = [li["mark"]["leading"] for li in seen if li["label"]["kind"] not in ("none", "outsider")]
    false = [bool(line["causes"]) for line in whole if line["label"]["kind"] == "none"]
    rights = [li["mark"]["right"] for li in seen]
    return [name, _rate(rights), _rate(known), _rate(false), str(len(lines) - len(whole))]


def _rate(marks: list[bool]) -> str:
    low, high = wilson(sum(marks), len(marks))
    return f"{sum(marks)} of {len(marks)} ({100 * low:.0f} to {100 * high:.0f} %)"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=40)
    parser.add_argument("--seed", type=int, default=11)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--only", action="append", choices=list(ABLATIONS))
    asked = parser.parse_args()
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    asked.out.mkdir(parents=True, exist_ok=True)
    cases = labels(asked.cases, asked.seed, "thesis")
    heads = ("", "all right", "first cause true", "false on healthy", "broken")
    print("".join(f"{head:26}" for head in heads).rstrip())
    for name in asked.only or list(ABLATIONS):
        cells = row(name, run(name, cases, asked.out, asked.processes))
        print("".join(f"{cell:26}" for cell in cells).rstrip(), flush=True)


if __name__ == "__main__":
    main()
