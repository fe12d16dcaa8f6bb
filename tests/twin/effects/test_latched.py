"""A pilot that opens at one error and shuts at a smaller one, against small steps of its law."""

from __future__ import annotations

import numpy as np
import pytest

from logs.recording import FloatArray
from tests.twin.judged import a_record
from tests.twin.kernels.test_kernels import excitation, run
from tests.twin.loops import D, plant
from twin.diagnose import diagnose

BAND_PSI, SHUTS = 0.3, 0.25
LATCHED = plant("before the lag", "ep_deadband", "overlap_latched", (BAND_PSI, SHUTS))


def in_small_steps(time_s: FloatArray, command: FloatArray) -> FloatArray:
    """tau dp/dt = u - p while the pilot is open; the command of a row holds since the one before."""
    p, is_open, found = float(command[0]), False, [float(command[0])]
    for h, u in zip(np.diff(time_s), command[1:], strict=True):
        for _ in range(100):
            error = u - p
            is_open = abs(error) > (SHUTS if is_open else 1.0) * BAND_PSI
            p += error * h / 100.0 / D.ep_tau_s if is_open else 0.0
        found.append(p)
    return np.array(found)


def test_like_small_steps_of_its_law() -> None:
    time_s, command = excitation(0.1)
    pressure, _ = run(LATCHED, time_s, command, 0.01)
    law = in_small_steps(time_s, command)
    assert np.max(np.abs(pressure - law)) < 0.02
    left = np.abs(pressure - command)[-1]
    assert left <= BAND_PSI + 1e-9


@pytest.mark.parametrize("shuts", [0.02, 0.25, 0.9])
def test_it_rests_where_it_shuts(shuts: float) -> None:
    """A step larger than the band ends a share of the band short; one that is smaller is ignored."""
    one = plant("before the lag", "ep_deadband", "overlap_latched", (BAND_PSI, shuts))
    time_s = np.arange(0.0, 40.0, 0.1)
    command = np.where(time_s < 10.0, 6.0, np.where(time_s < 30.0, 7.0, 7.0 - shuts * BAND_PSI - 0.9 * BAND_PSI))
    pressure, _ = run(one, time_s, command, 0.01)
    assert pressure[-1] == pressure[299] == pytest.approx(7.0 - shuts * BAND_PSI, abs=1e-4)


@pytest.mark.thorough
def test_it_is_named_and_its_numbers_found() -> None:
    found = diagnose([a_record(LATCHED, seed=3)], D).diagnosis
    assert [(c.name, c.form) for c in found.causes] == [("ep_deadband", "overlap_latched")]
    assert found.causes[0].parameters["band"].value == pytest.approx(BAND_PSI, rel=0.1)
    assert found.causes[0].parameters["shuts"].value == pytest.approx(SHUTS, abs=0.1)
