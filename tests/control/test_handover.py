"""The bump fades."""

from __future__ import annotations

import math

import pytest

from control.handover import Bump


def test_a_bump_fades_with_its_time_constant() -> None:
    bump = Bump.from_command(10.0, 7.0)
    for _ in range(20):
        bump = bump.fade(0.1, 2.0)
    assert bump.left_psi == pytest.approx(3.0 * math.exp(-1.0))
    assert bump.fade(0.1, 0.0).left_psi == 0.0
