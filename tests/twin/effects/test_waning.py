"""An exhaust that slows down as the pressure falls, against small steps of its law; and that it is told."""

from __future__ import annotations

import numpy as np
import pytest

from logs.recording import FloatArray
from tests.twin.judged import a_record
from tests.twin.kernels.test_kernels import excitation, run
from tests.twin.loops import D, plant
from twin.diagnose import diagnose
from twin.model.plant import Plant

WANES, BELOW = 3.0, 0.7
SHUT_PSI = D.a1 + D.travel / D.compliance
SLOW = plant("before the lag", "fill_exhaust_asymmetry", "waning", (WANES, BELOW))


def in_small_steps(time_s: FloatArray, command: FloatArray) -> FloatArray:
    """The command of a row holds since the one before."""
    p, found = float(command[0]), [float(command[0])]
    for h, u in zip(np.diff(time_s), command[1:], strict=True):
        for _ in range(100):
            below = max(D.a2 + BELOW * (SHUT_PSI - D.a2) - p, 0.0)
            longer = 1.0 + WANES * below / (SHUT_PSI - D.a2) if u < p else 1.0
            p += (u - p) * h / 100.0 / (longer * D.ep_tau_s)
        found.append(p)
    return np.array(found)


@pytest.mark.parametrize("step_s", [0.01, 0.05])
def test_like_small_steps_of_its_law(step_s: float) -> None:
    time_s, command = excitation(0.1)
    pressure, _ = run(SLOW, time_s, command, step_s)
    assert np.max(np.abs(pressure - in_small_steps(time_s, command))) < 0.02


def test_what_rises_and_what_is_above_it_is_the_designs() -> None:
    time_s = np.arange(0.0, 20.0, 0.1)
    for before, after, same in ((5.0, 11.0, True), (12.0, 11.0, True), (11.0, 5.0, False)):
        command = np.where(time_s < 5.0, before, after)
        (slow, _), (design, _) = (run(one, time_s, command, 0.01) for one in (SLOW, _of(0.0)))
        assert bool(np.max(np.abs(slow - design)) < 1e-9) is same


def _of(wanes: float) -> Plant:
    return plant("before the lag", "fill_exhaust_asymmetry", "waning", (wanes, BELOW))


@pytest.mark.thorough
def test_it_is_named_and_its_size_found() -> None:
    found = diagnose([a_record(SLOW, seed=3)], D).diagnosis
    assert [(c.name, c.form) for c in found.causes] == [("fill_exhaust_asymmetry", "waning")]
    assert found.causes[0].parameters["wanes"].value == pytest.approx(WANES, rel=0.15)
