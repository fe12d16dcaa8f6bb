"""Uses the program as an outsider does: CSV files in, diagnosis.json and an updated model out."""

from __future__ import annotations

import io
import json
import time
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.stranger.draw import Case
from bench.stranger.noise import QUIET, Noise, steps_per_row
from bench.stranger.plant import noise_free
from bench.stranger.record import run_closed, run_open, write_csv, write_open
from bench.stranger.valve import HEALTHY


def _call(name: str, *words: str | Path) -> None:
    """One verb of the command line, in this process and in silence."""
    from importlib import import_module

    verb = import_module(f"app.commands.{name}").command
    with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
        verb.main([str(word) for word in words], standalone_mode=False)


def diagnosed(case: Case, folder: Path) -> tuple[dict[str, Any], float]:
    """diagnosis.json of the case's recordings, and the seconds that it took."""
    paths = write_open(run_open(case.valve, case.session, case.noise, case.seed), case.session, folder)
    began_s = time.perf_counter()
    _call("diagnose", *paths, "--out", folder / "out")
    seconds = time.perf_counter() - began_s
    return json.loads((folder / "out" / "diagnosis.json").read_text(encoding="utf-8")), seconds


def _simulated_in(model: Path, closed: Path, out: Path) -> NDArray[np.float64]:
    """What a model says to the command of a record: positions [in], shape (rows,)."""
    _call("simulate", model, closed, "--out", out)
    with out.open(encoding="utf-8") as file:
        column = file.readline().strip().split(",").index("position_in")
        return np.loadtxt(file, delimiter=",", usecols=column, ndmin=1)


def closure(case: Case, folder: Path, noise: Noise) -> dict[str, float | None]:
    """How much of the gap of a closed-loop record that nobody saw the updated model closes: RMS [in] and share.

    The share is None where the design itself is hardly off (as in the interface, 1.05 times the noise), and where
    readings are false at random: no model can say when.
    """
    rows = run_closed(case.valve, noise, np.random.default_rng([*case.seed, 20]), case.seed)
    path = folder / "closed.csv"
    write_csv(rows, path)
    after_in = _rms(_simulated_in(folder / "out" / "model.toml", path, folder / "sim.csv") - rows.position_in)
    design = _design_in(rows.command_psi)
    before_in, floor_in = _rms(design - rows.position_in), noise.position_in
    share, random = None, any(cause.name == "sensor_dropouts" for cause in case.causes)
    if before_in > 1.05 * floor_in and not random:
        share = 1.0 - max(after_in**2 - floor_in**2, 0.0) / (before_in**2 - floor_in**2)
    return {"before_in": before_in, "after_in": after_in, "share": share}


def _design_in(command_psi: NDArray[np.float64]) -> NDArray[np.float64]:
    """The healthy plant's reading [in] under the commands [psi] of a closed loop, shape (rows,)."""
    steps = steps_per_row(QUIET, command_psi.size, np.random.default_rng(0))
    return noise_free(HEALTHY, command_psi, steps)[1]


def _rms(values: NDArray[np.float64]) -> float:
    return float(np.sqrt(np.mean(values**2)))
