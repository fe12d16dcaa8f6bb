"""A pilot with an overlap at one of its ports, against small steps of its law; it is no zero of a converter."""

from __future__ import annotations

import numpy as np
import pytest

from logs.recording import FloatArray
from tests.twin.judged import a_record
from tests.twin.kernels.test_kernels import excitation, run
from tests.twin.loops import D, plant
from twin.diagnose import diagnose
from twin.model.plant import Plant


def lapped(band_psi: float) -> Plant:
    return plant("before the lag", "ep_deadband", "overlap_one_side", (band_psi,))


def in_small_steps(time_s: FloatArray, command: FloatArray, band_psi: float) -> FloatArray:
    """tau dp/dt = what is beyond the band of a rising error, or of a falling one, and all of the other."""
    p, found = float(command[0]), [float(command[0])]
    for h, u in zip(np.diff(time_s), command[1:], strict=True):
        for _ in range(100):
            error = u - p
            flow = error - np.clip(error, min(band_psi, 0.0), max(band_psi, 0.0))
            p += flow * h / 100.0 / D.ep_tau_s
        found.append(p)
    return np.array(found)


@pytest.mark.parametrize("band_psi", [0.4, -0.4])
def test_like_small_steps_of_its_law(band_psi: float) -> None:
    time_s, command = excitation(0.1)
    pressure, _ = run(lapped(band_psi), time_s, command, 0.01)
    assert np.max(np.abs(pressure - in_small_steps(time_s, command, band_psi))[50:]) < 0.02


@pytest.mark.thorough
@pytest.mark.parametrize("band_psi", [0.12, -0.07])
def test_it_is_named_alone(band_psi: float) -> None:
    found = diagnose([a_record(lapped(band_psi), seed=3)], D).diagnosis
    assert [(c.name, c.form) for c in found.causes] == [("ep_deadband", "overlap_one_side")]
    assert found.causes[0].parameters["band"].value == pytest.approx(band_psi, rel=0.1)


@pytest.mark.thorough
def test_a_zero_beside_ports_that_overlap_alike_is_two_causes() -> None:
    both = plant("before the lag", "ep_deadband", "overlap", (0.1,))
    off = plant("before the lag", "ep_calibration", "zero", (0.25,))
    found = diagnose([a_record(Plant(both.design, (*both.inserted, *off.inserted)), seed=3)], D).diagnosis
    assert {c.name for c in found.causes} == {"ep_deadband", "ep_calibration"}
