"""The filter through the play: what it learns, how sure it says it is, and how sure it may be."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from app.physics_bench import open_virtual
from control.controller import Seen
from control.design import DesignModel
from control.lateness import Lateness
from control.play_filter import NOISE_IN, NOISE_PSI, Belief, PlayFilter
from control.play_points import A2, SIZE

DESIGN = DesignModel()
TICK_S = 0.1
STAIRS = np.repeat([10.5, 8.4, 11.2, 7.4, 10.8, 8.0], 250)

RUNS = np.repeat([14.0, 2.0, 14.0, 2.0], 80)  # from stop to stop


def watch(
    seed: int, noise: float = 1.0, stairs: npt.NDArray[np.float64] = STAIRS, **numbers: float
) -> tuple[Belief, Mapping[str, float]]:
    """The belief after going up and down a few times, and the truth: stem and plate."""
    opened = open_virtual(seed, numbers=numbers, noise=noise)
    watcher, sample = PlayFilter(DESIGN), opened.bench.exchange(0.0)
    belief = watcher.start(seen(sample))
    for tick, command_psi in enumerate(stairs):
        belief, _ = watcher.track(belief, seen(sample), TICK_S, Lateness())
        opened.clock.sleep_until((tick + 1) * TICK_S)
        sample = opened.bench.exchange(float(command_psi))
    state = opened.bench.physics.state  # type: ignore[attr-defined]
    return belief, {"stem": float(state["stem"][0]), "plate": float(state["slider"][0])}


def seen(sample: object) -> Seen:
    return Seen(sample.position.value, sample.pressure.value, sample.commanded_psi)  # type: ignore[attr-defined]


@pytest.mark.parametrize(("a1", "a2"), [(8.78, 5.82), (9.0, 5.6), (8.55, 6.0)])
def test_both_edges_are_learned(a1: float, a2: float) -> None:
    belief, _ = watch(1, a1=a1, a2=a2)
    k = belief.compliance
    for side, edge in ((1, a1), (-1, a2)):
        assert belief.edge_psi(0.25, side) == pytest.approx(edge + 0.25 / DESIGN.compliance, abs=0.06)
        assert belief.edge_doubt_in(side) / k < 0.05


@pytest.mark.thorough
@pytest.mark.parametrize("noise", [1.0, 4.0])
def test_it_is_as_sure_as_it_may_be(noise: float) -> None:
    """Over seeds, the play output is within three standard deviations, and these are small."""
    for seed in range(6):
        belief, truth = watch(seed, noise=noise)
        assert abs(belief.inside.w - truth["plate"]) < 3.0 * belief.doubt_in
        assert belief.doubt_in < 0.002 * DESIGN.travel * noise


def test_the_noise_is_measured() -> None:
    assert watch(2, noise=1.0)[0].noise_in == pytest.approx(0.0006, rel=0.35)
    assert watch(2, noise=4.0)[0].noise_in == pytest.approx(0.0024, rel=0.35)


def test_large_noise_is_heard_before_the_first_move() -> None:
    """Else the first moves teach edges that are not there."""
    heard = [watch(seed, noise=4.0, stairs=np.zeros(8))[0].noise_in for seed in range(6)]
    assert np.median(heard) > 0.001
    assert np.median([watch(seed, stairs=np.zeros(8))[0].noise_in for seed in range(6)]) < 0.0008


def rested(noise: float, seed: int) -> float:
    """How far the pressure that a command is thought to settle at wanders over 30 s of one command, without a reason
    but noise: standard deviation [psi]."""
    opened = open_virtual(seed, noise=noise)
    watcher, sample, found = PlayFilter(DESIGN), opened.bench.exchange(8.0), []
    belief = watcher.start(seen(sample))
    for tick in range(400):
        belief, _ = watcher.track(belief, seen(sample), TICK_S, Lateness())
        found.append(belief.inside.settles(8.0))
        opened.clock.sleep_until((tick + 1) * TICK_S)
        sample = opened.bench.exchange(8.0)
    return float(np.std(found[100:]))


def test_a_loud_gauge_does_not_shake_the_commands() -> None:
    """What is taken for the converter's zero goes into the next command; 0.009 psi push a plate by 0.3 % of travel."""
    usual, loud = (np.median([rested(noise, seed) for seed in range(5)]) for noise in (1.0, 4.0))
    assert loud < 3.0 * usual


@pytest.mark.parametrize(("stem", "pressure", "loud"), [(3.0, 3.0, True), (3.0, 1.0, False), (1.0, 3.0, False)])
def test_moves_that_are_not_as_predicted_are_no_noise(stem: float, pressure: float, loud: bool) -> None:
    """Late readings or a wrong compliance make the stem alone look loud, a dead time the pressure."""
    start = PlayFilter(DESIGN).start(Seen(0.1, 9.5, 9.5))
    assert replace(start, noise_in=stem * NOISE_IN, noise_psi=pressure * NOISE_PSI).is_loud == loud


@pytest.mark.parametrize(("times", "walk_psi"), [(1.0, 0.03), (3.0, 0.012)])
def test_a_move_takes_less_of_an_edge_that_loud_readings_cannot_teach_anew(times: float, walk_psi: float) -> None:
    watcher = PlayFilter(DESIGN)
    start = watcher.start(Seen(0.1, 9.5, 9.5))
    belief = replace(start, noise_in=times * NOISE_IN, noise_psi=times * NOISE_PSI)
    before, after_psi = belief.spread[SIZE * A2 + A2], belief.inside.p + 1.0
    started_in = belief.inside.w
    for _ in range(20):
        belief = watcher.ahead(belief, after_psi, TICK_S)
    went = (belief.inside.w - started_in) / DESIGN.travel
    assert went > 0.2
    assert belief.spread[SIZE * A2 + A2] - before == pytest.approx(walk_psi * walk_psi * went, rel=0.02)


@pytest.mark.parametrize("rate_limit", [0.115, 0.125])
def test_the_rate_limit_is_learned(rate_limit: float) -> None:
    assert watch(3, stairs=RUNS, rate_limit=rate_limit)[0].rate_limit == pytest.approx(rate_limit, rel=0.015)


@pytest.mark.parametrize("travel", [0.553, 0.572])
def test_the_upper_stop_is_learned(travel: float) -> None:
    assert watch(3, stairs=RUNS, travel=travel)[0].travel == pytest.approx(travel, rel=0.003)


def test_numbers_of_another_belief_have_nothing_to_do_with_the_rest() -> None:
    belief, other = watch(1)[0], watch(2, a1=9.0, a2=5.5)[0]
    moved = belief.with_numbers(other)
    assert (moved.inside.a1, moved.inside.a2, moved.compliance) == (
        other.inside.a1,
        other.inside.a2,
        other.compliance,
    )
    assert (moved.inside.w, moved.doubt_in) == (belief.inside.w, belief.doubt_in)
    cov = np.array(moved.spread).reshape(7, 7)
    assert cov[4:, 4:] == pytest.approx(np.array(other.spread).reshape(7, 7)[4:, 4:])
    assert not cov[:4, 4:].any()


def test_a_rest_on_a_stop_teaches_nothing() -> None:
    opened = open_virtual(0)
    watcher, sample = PlayFilter(DESIGN), opened.bench.exchange(0.0)
    belief = first = watcher.start(seen(sample))
    for tick in range(200):
        belief, _ = watcher.track(belief, seen(sample), TICK_S, Lateness())
        opened.clock.sleep_until((tick + 1) * TICK_S)
        sample = opened.bench.exchange(2.0)
    assert (belief.inside.a1, belief.inside.a2) == (first.inside.a1, first.inside.a2)
    assert np.all(np.linalg.eigvalsh(np.array(belief.spread).reshape(7, 7)) > -1e-12)


@pytest.mark.parametrize(("ticks", "went_in"), [(0.0, 0.0), (0.5, 2.0), (2.25, 6.25), (9.0, 7.0)])
def test_how_far_the_stem_went_lately(ticks: float, went_in: float) -> None:
    belief = replace(PlayFilter(DESIGN).start(Seen(0.2, 8.3, 8.3)), went=(4.0, 2.0, 1.0))
    assert belief.went_in(ticks) == went_in
