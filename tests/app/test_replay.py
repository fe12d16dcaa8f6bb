"""A record made over Modbus, read back from disk, reproduces every command bit for bit.

The record has the command as the bench wrote it: as a float32, because that is the profile's command register.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from app.commands.run import command as run
from control.controller import make_controller
from control.design import DesignModel
from hal.sample import Quality, Reading, Sample
from logs.run import read_run


@pytest.mark.parametrize("name", ["brake", "overdrive", "if_then_pi", "pi_antiwindup"])
def test_a_record_replays_bit_for_bit(name: str, tmp_path: Path) -> None:
    arguments = ["--controller", name, "--targets", "0.1,0.3", "--hold", "10", "--out", str(tmp_path / "run")]
    CliRunner().invoke(run, arguments, catch_exceptions=False)
    columns = read_run(tmp_path / "run").columns
    rows = {key: np.asarray(getattr(columns[key], "values", columns[key]), dtype=float) for key in columns}
    controlled = np.nonzero(np.isfinite(rows["target_in"]))[0]
    controller = make_controller(name, DesignModel())
    state, wrong = None, []
    for k in controlled[:-1]:
        quality = Quality(int(rows["quality"][k]))
        sample = Sample(
            rows["time_s"][k],
            rows["next_command_psi"][k],
            Reading(rows["position_in"][k], 0.0, 0.0, quality),
            Reading(rows["pressure_psi"][k], 0.0, 0.0, Quality(int(rows["pressure_quality"][k]))),
        )
        target = rows["target_in"][k]
        state = controller.initial(sample, target) if state is None else state
        state, command = controller.step(state, sample, target, 0.1)
        if np.float32(command) != rows["next_command_psi"][k + 1]:
            wrong.append(k)
    assert controlled.size > 190
    assert wrong == []
