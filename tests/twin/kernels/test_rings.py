"""Elastic rings: the plays that they make against the springs themselves, pressed against a stop and come off it."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import FloatArray
from twin.kernels.rings import rings_target, unstretched_rings
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant, curve_tables

DESIGN = DesignModel()
ELASTIC, LONGEST_IN, NEARER = 0.4, 0.14, 0.12


def up_and_down(*ends: float) -> FloatArray:
    """A pressure that goes slowly from one end to the next [psi]."""
    legs = [np.linspace(a, b, int(abs(b - a) / 0.01) + 1)[1:] for a, b in pairwise(ends)]
    return np.concatenate([ends[:1], *legs])


def springs(force: FloatArray) -> FloatArray:
    """The stem by the springs themselves, each anchored where it last slipped; rigid friction bears the rest."""
    friction = 0.5 * DESIGN.deadband
    slips = LONGEST_IN * np.array([NEARER, 1.0])
    rates, rigid = 0.5 * ELASTIC * friction / slips, (1.0 - ELASTIC) * friction
    x, anchors, out = 0.0, np.zeros(2), []
    step = 1e-4 * DESIGN.travel

    def needed(to: float) -> float:
        held = np.clip(to - anchors, -slips, slips)
        return 0.5 * (DESIGN.a1 + DESIGN.a2) + to / DESIGN.compliance + float(rates @ held)

    for p in force:
        while x + step <= DESIGN.travel and p > needed(x + step) + rigid:
            x += step
            anchors = np.maximum(anchors, x - slips)
        while x - step >= 0.0 and p < needed(x - step) - rigid:
            x -= step
            anchors = np.minimum(anchors, x + slips)
        out.append(x)
    return np.array(out)


@pytest.mark.parametrize(
    "ends",
    [(7.0, 9.6, 7.4, 9.9, 8.2, 9.4), (7.0, 14.0, 7.5, 10.5, 4.0, 12.0), (7.0, 4.0, 10.0, 3.0, 14.0, 6.0)],
    ids=["within", "beyond open", "beyond both"],
)
def test_rings_go_as_the_springs_do(ends: tuple[float, ...]) -> None:
    form = effect("distributed_hysteresis").form("two_rings")
    c = Plant(DESIGN, (Inserted("distributed_hysteresis", form, (ELASTIC, LONGEST_IN, NEARER)),)).coefficients(1.0)
    force = up_and_down(*ends)
    state = unstretched_rings(0.0, c.spreads.size)
    found = rings_target(force, np.zeros(1), (0.0, DESIGN.travel), curve_tables(c), c.spreads, c.weights, state)
    assert np.abs(found - springs(force)).max() < 5e-4 * DESIGN.travel
    widening = np.zeros(force.size)  # one number for each point: no shortcut at the stops
    again = rings_target(
        force,
        widening,
        (0.0, DESIGN.travel),
        curve_tables(c),
        c.spreads,
        c.weights,
        unstretched_rings(0.0, c.spreads.size),
    )
    assert np.abs(again - found).max() < 1e-9


def test_the_mean_width_is_the_designs_and_nothing_elastic_is_the_design() -> None:
    for form, values in (("two_rings", (ELASTIC, LONGEST_IN, NEARER)), ("rings", (ELASTIC, LONGEST_IN))):
        law = effect("distributed_hysteresis").form(form)
        c = Plant(DESIGN, (Inserted("distributed_hysteresis", law, values),)).coefficients(1.0)
        assert float(c.weights.sum()) == pytest.approx(1.0)
        assert float(c.weights @ c.spreads) == pytest.approx(0.0, abs=1e-9)
        none = Plant(DESIGN, (Inserted("distributed_hysteresis", law, (0.0, *values[1:])),)).coefficients(1.0)
        assert none.spreads.tolist() == [0.0]
