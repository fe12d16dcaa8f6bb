"""Examines the diagnosis with somebody's sealed folder: `python -m bench.exam FOLDER --out ANSWERS [--processes 2]`.

The folder holds `design.toml` (or none), `caseNN/*.csv` (the recordings of one machine each) and `SEALED.json`: for
each case, by themselves or all under `cases`, `cls` (healthy, number, single, pair, outsider) and `truth`, its causes.
`unseen/caseNN.csv` with `unseen/caseNN.npz` (`x_analog`: what the gauge would have read without noise, in the unit of
the record's position) is the same machine on a record that the diagnosis is never shown. The program is called as
anybody calls it; every answer stays in ANSWERS, and a run that was stopped goes on where it was. The labels are opened
when the last answer is written.
With `--claims docs/strangers.json` what was said is kept there, too, under the digits that end FOLDER's name.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bench.called import call
from bench.exam_claims import keep, seed_of
from bench.exam_score import Answer, claims, label_of, text
from control.design import DesignModel, load_design, save_design
from hal.errors import BadInput
from logs.roles import split_header
from logs.units import conversion
from twin.model.model_units import in_units_of

_KEPT = ("verdict", "causes", "confusable", "ranking", "where", "gap", "data_quality")
_DIGITAL = ("sensor_quantization", "stale_samples", "sensor_dropouts")
_HALF_A_STEP = (("sensor_quantization", "step"), ("lvdt_calibration", "zero"))


def answered(folder: Path, out: Path, case: str) -> Path:
    """The file with the answer to a case, which is made if it is not there; an error is an answer, too."""
    path = out / f"{case}.json"
    if not path.exists():
        began_s = time.perf_counter()
        said = _diagnosed(folder, out / case, case)
        said |= {"seconds": round(time.perf_counter() - began_s, 1), "unseen": _unseen(folder, out / case, case)}
        path.write_text(json.dumps(said), encoding="utf-8")
    return path


def cases_of(folder: Path) -> list[str]:
    """The names of the cases: folders with at least one recording."""
    return sorted(path.name for path in folder.glob("case*") if any(path.glob("*.csv")))


def _diagnosed(folder: Path, out: Path, case: str) -> dict[str, object]:
    runs, design = sorted((folder / case).glob("*.csv")), folder / "design.toml"
    words = ["diagnose", *map(str, runs), *(["--design", str(design)] if design.exists() else []), "--out", str(out)]
    try:
        call(*words)
    except subprocess.SubprocessError as error:
        return {"error": str(getattr(error, "stderr", "") or error).strip()[-400:]}
    said = json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))
    return {key: said[key] for key in _KEPT}


def _unseen(folder: Path, out: Path, case: str) -> dict[str, float] | None:
    """RMS [in] by which the design and the updated model miss the reading of a record that was never shown."""
    record, truth, design = folder / "unseen" / f"{case}.csv", folder / "unseen" / f"{case}.npz", folder / "design.toml"
    if not (record.exists() and truth.exists() and design.exists() and (out / "model.toml").exists()):
        return None
    reading_in = np.load(truth)["x_analog"] * _unit_in(record)
    analogue = out / "analogue.toml"
    save_design(_analogue(load_design(out / "model.toml")), analogue)
    models = {"before_in": design, "after_in": analogue}
    try:
        return {key: _miss_in(model, record, reading_in, out / "simulated.csv") for key, model in models.items()}
    except subprocess.CalledProcessError as error:
        print(
            f"{case}: the unseen record cannot be simulated: {error.stderr.strip()[-400:]}", file=sys.stderr, flush=True
        )
        return None


def _unit_in(record: Path) -> float:
    """What the unit of a record's position is [in]; where it says none, an inch."""
    with record.open(encoding="utf-8") as file:
        headers = file.readline().strip().split(",")
    columns = [split_header(header, "position") for header in headers]
    unit = next((column.unit for column in columns if column.label == "position"), "")
    return conversion(unit or "in", "position").scale


def _analogue(model: DesignModel) -> DesignModel:
    """The model without what makes a reading digital, which the readings that it is compared with are without, too.

    A display that cuts off its digits reads low by half a step, which is in the model as a zero of exactly that.
    """
    step, zero = (float(model.effects.get(n, {}).get(k, 0.0)) for n, k in _HALF_A_STEP)
    without = {*_DIGITAL, *({"lvdt_calibration"} if step and np.isclose(zero, -0.5 * step, rtol=1e-6) else ())}
    return replace(model, effects={name: table for name, table in model.effects.items() if name not in without})


def _miss_in(model: Path, record: Path, reading_in: NDArray[np.float64], out: Path) -> float:
    call("simulate", str(model), str(record), "--out", str(out))
    with out.open(encoding="utf-8") as file:
        column = file.readline().strip().split(",").index("position_in")
        simulated_in = np.loadtxt(file, delimiter=",", usecols=column, ndmin=1)
    return float(np.sqrt(np.mean((simulated_in - reading_in) ** 2)))


def _travel_in(design: Path) -> float:
    """Travel of the design, of the thesis's where there is no file: recordings are in inches, whatever its unit."""
    return in_units_of(load_design(design) if design.exists() else DesignModel(), "psi", "in").travel


def main() -> None:
    """Answers what is not answered yet, then opens the labels and prints what was right."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--claims", type=Path)
    options = parser.parse_args()
    try:
        seed = seed_of(options.folder) if options.claims else ""
    except BadInput as error:
        sys.exit(str(error))  # before an hour of answers, not after
    options.out.mkdir(parents=True, exist_ok=True)
    cases = cases_of(options.folder)
    with ThreadPoolExecutor(options.processes) as pool:
        for path in pool.map(partial(answered, options.folder, options.out), cases):
            print(f"{path.stem} answered", file=sys.stderr, flush=True)
    travel_in = _travel_in(options.folder / "design.toml")
    sealed = json.loads((options.folder / "SEALED.json").read_text(encoding="utf-8"))
    sealed = sealed.get("cases", sealed)
    said = {case: json.loads((options.out / f"{case}.json").read_text(encoding="utf-8")) for case in cases}
    try:
        answers = [Answer(case, label_of(case, sealed.get(case)), said[case], travel_in) for case in cases]
    except BadInput as error:
        sys.exit(str(error))
    print(text(answers))
    if options.claims:
        keep(options.claims, seed, claims(answers))


if __name__ == "__main__":
    main()
