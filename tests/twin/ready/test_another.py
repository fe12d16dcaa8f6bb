"""When a record is of another valve than the one whose numbers it is held against."""

from __future__ import annotations

from dataclasses import replace

import pytest

from control.design import DesignModel
from twin.ready.another import far_off, is_another

THESIS = DesignModel()
LOOSE = replace(THESIS, a1=6.0, a2=5.8, compliance=0.1, tau_s=1.0)


@pytest.mark.parametrize(
    ("own", "left", "missed", "another"),
    [
        (LOOSE, 0.01, 0.30, True),
        (LOOSE, 0.10, 0.30, False),  # its own numbers do not explain it either
        (LOOSE, 0.01, 0.09, False),  # not far off
        (replace(THESIS, a1=11.0, tau_s=8.0), 0.01, 0.30, False),  # two numbers are wrong (offset 15 %)
        (replace(THESIS, tau_s=8.0, compliance=0.1), 0.01, 0.30, False),
        (replace(THESIS, tau_s=8.0, compliance=0.1, travel=1.2), 0.01, 0.30, True),
        (replace(THESIS, tau_s=8.0, compliance=0.1, travel=1.2), 0.03, 0.30, False),  # 0.036 in of 0.169
    ],
)
def test_it_is_by_three_signs_together(own: DesignModel, left: float, missed: float, another: bool) -> None:
    assert is_another(own, left, THESIS, missed) is another
    assert far_off(missed) or not another
