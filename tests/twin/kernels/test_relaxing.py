"""A spring of which a part relaxes, held by the friction of what drives the stem: against small steps of its law."""

from __future__ import annotations

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import FloatArray
from twin.kernels.valve import coupled_coefficients
from twin.kernels.valve_slots import V_RELAX, V_RELAX_TARGET
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant, stem_response
from twin.model.timegrid import make_grid

D = DesignModel()
K = D.compliance
TIME_S = np.arange(0.0, 160.05, 0.1)
#: Up, a rest in the deadband, down, up to the stop and away from it.
PRESSURE = np.interp(
    TIME_S, [0, 5, 15, 60, 62, 90, 92, 110, 120, 160], [8.0, 8.0, 10.5, 10.5, 7.0, 7.0, 6.5, 12.5, 12.5, 5.0]
)


def creeping(form: str, *values: float) -> Inserted:
    return Inserted("creep", effect("creep").form(form), values)


def stem(plant: Plant) -> FloatArray:
    grid = make_grid(TIME_S, 0.02)
    fine = np.interp(grid.fine_time_s, TIME_S, PRESSURE)
    return stem_response(plant.coefficients(160.0), grid, fine, 0.0, 0.0)[grid.offsets]


def stepped(share: float, tail_s: float, per: int = 100) -> FloatArray:
    """The same by explicit steps of a millisecond: the spring, its relaxed part and friction hold the target."""
    w, z, x, h, rows = 0.0, 0.0, 0.0, 0.1 / per, [0.0]
    for k in range(1, TIME_S.size):
        for n in range(per):
            p = PRESSURE[k - 1] + (PRESSURE[k] - PRESSURE[k - 1]) * (n + 1) / per
            pull = p - share * (w - z) / K
            # beyond what friction takes the target gives way, by the spring's whole rate
            off = pull - D.a1 - w / K if pull > D.a1 + w / K else min(0.0, pull - D.a2 - w / K)
            w = min(D.travel, max(0.0, w + K * off / (1.0 + share)))
            z += h / tail_s * (w - z)
            speed = max(-D.rate_limit, min(D.rate_limit, (w - x) / D.tau_s))
            x = min(D.travel, max(0.0, x + h * speed))
        rows.append(x)
    return np.array(rows)


@pytest.mark.parametrize(("share", "tail_s"), [(0.3, 12.0), (-0.1, 30.0)])
def test_it_is_the_law_in_small_steps(share: float, tail_s: float) -> None:
    found = stem(Plant(D, (creeping("driven_spring_tail", share, tail_s),)))
    assert np.abs(found - stepped(share, tail_s)).max() < 1e-3 * D.travel
    assert np.abs(found - stem(Plant(D))).max() > 0.02 * D.travel


def test_it_goes_on_while_friction_holds_the_stem() -> None:
    """What came after while it stood holds the stem back on its way down, and comes after there, too."""
    apart = stem(Plant(D, (creeping("driven_spring_tail", 0.3, 12.0),))) - stem(Plant(D))
    assert np.interp(68.0, TIME_S, apart) > 0.02 * D.travel
    assert abs(np.interp(89.0, TIME_S, apart)) < 0.5 * np.interp(68.0, TIME_S, apart)


def test_of_next_to_no_share_it_is_the_play() -> None:
    relaxes = Plant(D, (creeping("driven_spring_tail", 1e-9, 12.0),))
    assert relaxes.coefficients(160.0).valve[V_RELAX_TARGET] != 0.0
    np.testing.assert_allclose(stem(relaxes), stem(Plant(D)), atol=1e-8)


def test_where_target_and_stem_act_on_each_other_it_is_a_spring_of_the_stem() -> None:
    friction = Inserted("friction_in_motion", effect("friction_in_motion").form("partial"), (0.3,))
    both = Plant(D, (friction, creeping("driven_spring_tail", 0.2, 12.0)))
    stems = Plant(D, (friction, creeping("spring_tail", 0.2, 12.0)))
    np.testing.assert_allclose(stem(both), stem(stems), atol=1e-12)
    c = coupled_coefficients(both.coefficients(1.0).valve)
    assert c[V_RELAX] == pytest.approx(0.2 / K) == both.coefficients(1.0).valve[V_RELAX_TARGET]
