"""How late readings are, from how moves begin."""

from __future__ import annotations

import pytest

from control.dead_time import no_dead_time
from control.design import DesignModel
from control.exact import lag
from control.lateness import Lateness
from control.observer import Inside, Observer, follow

DESIGN = DesignModel()
TICK_S, FINE = 0.1, 100


def inside(w: float, x: float, psi: float) -> Inside:
    return Inside(psi, w, x, DESIGN.a1, DESIGN.a2, psi, no_dead_time(psi))


def moved(late_s: float, grip_psi: float = 0.0, from_in: float = 0.2, way: int = 1) -> Lateness:
    """After a move from the middle of the gap to 3 psi beyond an edge, which holds on by `grip_psi` more."""
    edge_psi = (DESIGN.a1 if way > 0 else DESIGN.a2) + from_in / DESIGN.compliance
    psi = start_psi = DESIGN.offset + from_in / DESIGN.compliance
    aim_psi, step_s = edge_psi + 3.0 * way, TICK_S / FINE
    w = x = from_in
    stems = [from_in] * (round(late_s / step_s) + 1)
    late = Lateness().begun(way, inside(w, x, psi), edge_psi, from_in + way * 0.2, start_psi)
    for _ in range(20):
        for _ in range(FINE):
            psi += lag(step_s, DESIGN.ep_tau_s) * (aim_psi - psi)
            gone_in = DESIGN.compliance * way * (psi - edge_psi)
            w = from_in + way * gone_in if gone_in > DESIGN.compliance * grip_psi else w
            x = follow(x, w, DESIGN.tau_s, DESIGN.rate_limit, step_s)
            stems.append(x)
        late = late.read(Observer(DESIGN), stems[-1 - round(late_s / step_s)], psi, TICK_S)
    return late


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize("late_s", [0.0, 0.15, 0.4, 0.8])
def test_it_is_told_from_how_a_move_begins(late_s: float, way: int) -> None:
    late = moved(late_s, way=way)
    assert late.late_s == pytest.approx(late_s, abs=0.02)
    assert late.count == 1
    assert late.known_s == (late.late_s if late_s > 0.1 else 0.0)


def test_a_plate_that_sticks_is_not_late() -> None:
    assert moved(0.0, grip_psi=0.3).known_s == 0.0
    assert moved(0.4, grip_psi=0.3).late_s == pytest.approx(0.4, abs=0.06)


@pytest.mark.parametrize(("w", "target_in", "watched"), [(0.2, 0.25, True), (0.2, 0.21, False), (0.22, 0.25, False)])
def test_a_long_move_from_rest_is_watched(w: float, target_in: float, watched: bool) -> None:
    assert Lateness().begun(1, inside(w, 0.2, 8.3), 9.8, target_in, 8.3).awaited == watched


def test_what_does_not_begin_says_nothing() -> None:
    late = Lateness(0.3, 2).begun(1, inside(0.2, 0.2, 8.3), 9.8, 0.3, 8.3)
    for _ in range(40):
        late = late.read(Observer(DESIGN), 0.2, 8.3, TICK_S)
    assert late == Lateness(0.3, 2)
