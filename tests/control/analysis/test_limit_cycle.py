"""Predicted limit cycles: the thesis's conclusion, python-control's numbers, harmonic balance, the virtual valve."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from app.hunting import measured, study
from control.analysis.harmonic_balance import balance, find_cycles
from control.analysis.limit_cycle import grows, predict
from control.analysis.loop import LinearLoop, thesis_loop
from control.analysis.measured import measure_cycle
from control.design import DesignModel
from control.tune import hunts, margins, phase_margin

DESIGN = DesignModel()


class Rational(LinearLoop):
    """3 / (0.4 s (0.05 s + 1)) before the play: a loop that python-control can have too."""

    def before_play(self, omega: npt.NDArray[np.float64]) -> npt.NDArray[np.complex128]:
        s = 1j * omega
        return np.asarray(3.0 / (0.4 * s * (0.05 * s + 1.0)), dtype=np.complex128)


def test_the_thesis_is_right_about_one_lag() -> None:
    assert predict(thesis_loop(), DESIGN) == []


def test_intersections_agree_with_python_control() -> None:
    """`control.describing_function_response` (0.10.2) gives amplitudes and frequencies of both intersections."""
    found = predict(Rational("p", 3.0, tick_s=0.0), DESIGN)
    assert [(c.pressure_psi, c.omega) for c in found] == [
        (pytest.approx(1.6468, rel=2e-3), pytest.approx(0.16577, rel=5e-3)),
        (pytest.approx(2.5540, rel=2e-3), pytest.approx(0.45484, rel=5e-3)),
    ]
    assert [c.stable for c in found] == [False, True]


def test_the_positional_law_never_hunts_and_the_incremental_one_does() -> None:
    assert predict(LinearLoop("p", 3.0), DESIGN) == []
    assert predict(LinearLoop("p_incremental", 1.0), DESIGN) == []
    assert any(c.stable for c in predict(LinearLoop("p_incremental", 3.0), DESIGN))


def test_delay_makes_a_pi_loop_worse() -> None:
    quick, slow = (predict(LinearLoop("pi", 3.0, 8.0, dead_time_s=d), DESIGN)[-1] for d in (0.0, 0.5))
    assert slow.stem_in > quick.stem_in


def test_delay_calms_the_incremental_law() -> None:
    """It accumulates once per round trip, so a longer round trip accumulates more slowly."""
    assert predict(LinearLoop("p_incremental", 3.0, dead_time_s=0.5), DESIGN) == []


def test_prediction_balance_and_measurement_agree() -> None:
    (case,) = study([LinearLoop("p_incremental", 3.0)], DESIGN, duration_s=400.0)
    assert case.predicted is not None and case.measured is not None
    assert case.predicted.stem_in == pytest.approx(case.measured.stem_in, rel=0.08)
    assert case.balanced[0].stem_in == pytest.approx(case.measured.stem_in, rel=0.02)
    assert case.balanced[0].period_s == pytest.approx(case.measured.period_s, rel=0.02)


@pytest.mark.parametrize("loop", [LinearLoop("pi", 3.0, 6.0), LinearLoop("p_incremental", 2.5)])
def test_the_balance_finds_what_the_describing_function_misses(loop: LinearLoop) -> None:
    """Just below the border of the describing function the valve hunts all the same."""
    (case,) = study([loop], DESIGN)
    assert case.predicted is None and case.measured is not None
    assert case.balanced[0].stem_in == pytest.approx(case.measured.stem_in, rel=0.06)
    assert case.balanced[0].period_s == pytest.approx(case.measured.period_s, rel=0.05)


@pytest.mark.parametrize("loop", [LinearLoop("p", 3.0), LinearLoop("p_incremental", 1.0), LinearLoop("pi", 3.0, 3.0)])
def test_the_balance_finds_nothing_where_nothing_hunts(loop: LinearLoop) -> None:
    assert find_cycles(loop, DESIGN) == []


def test_the_valve_that_is_measured_has_the_numbers_of_the_design() -> None:
    """Half the compliance and twice the gain are the same loop, with half the rate limit per psi made up for."""
    half = replace(DESIGN, compliance=0.5 * DESIGN.compliance, rate_limit=0.5 * DESIGN.rate_limit)
    soft, stiff = (
        measured(LinearLoop("p_incremental", kp), design, 400.0) for kp, design in ((3.0, DESIGN), (6.0, half))
    )
    assert soft is not None and stiff is not None
    assert stiff.period_s == pytest.approx(soft.period_s, rel=0.01)
    assert 2.0 * stiff.stem_in == pytest.approx(soft.stem_in, rel=0.02)


def test_dead_time_and_a_late_reading_reach_the_valve() -> None:
    """Dead time is inside the incremental law's round trip and calms it; a late reading is outside, and does not."""
    calm, late = LinearLoop("p_incremental", 3.0, dead_time_s=0.5), LinearLoop("p_incremental", 3.0, late_s=0.2)
    assert measured(calm, DESIGN, 600.0) is None and find_cycles(calm, DESIGN) == []
    worse, plain = measured(late, DESIGN, 600.0), measured(LinearLoop("p_incremental", 3.0), DESIGN, 600.0)
    assert worse is not None and plain is not None
    assert worse.stem_in > 1.5 * plain.stem_in
    assert find_cycles(late, DESIGN)[0].stem_in == pytest.approx(worse.stem_in, rel=0.05)


def test_a_loop_that_is_unstable_with_the_play_wide_open_grows() -> None:
    assert grows(LinearLoop("pi", 3.0, 8.0, dead_time_s=1.0), DESIGN)
    assert not grows(LinearLoop("pi", 3.0, 3.0), DESIGN)


@pytest.mark.parametrize(("share", "answer"), [(0.97, False), (1.03, True)])
def test_growth_begins_where_the_loop_with_the_plays_full_slope_passes_minus_one(share: float, answer: bool) -> None:
    loop = LinearLoop("pi", 3.0, 8.0, dead_time_s=1.0)
    line = loop(loop.frequencies(20000)) * DESIGN.compliance
    passes = (np.diff(np.sign(line.imag)) != 0) & (line.real[:-1] < 0.0)
    factor = share / float(np.abs(line[:-1][passes]).max())
    assert grows(replace(loop, kp=factor * loop.kp, ki=factor * loop.ki), DESIGN) == answer


def test_the_rate_limit_is_seen_by_the_balance() -> None:
    fast = LinearLoop("p_incremental", 3.0)
    cycle = predict(fast, DESIGN)[-1]
    free = balance(fast, DesignModel(rate_limit=10.0), cycle)
    slow = balance(fast, DesignModel(rate_limit=0.06), cycle)
    assert slow.period_s > 1.02 * free.period_s


def test_a_quiet_or_dying_record_has_no_cycle() -> None:
    t = np.arange(0.0, 200.0, 0.1)
    assert measure_cycle(t, 0.001 * np.sin(t), 0.01) is None
    assert measure_cycle(t, np.exp(-t / 30.0) * np.sin(t), 1e-4) is None
    slowly = np.exp(-t / 500.0) * np.sin(t)  # 10 % less from quarter to quarter
    assert measure_cycle(t, slowly, 1e-4) is None
    steady = measure_cycle(t, 0.2 * np.sin(t), 0.01)
    assert steady is not None
    assert steady.period_s == pytest.approx(2.0 * np.pi, rel=0.01)
    assert steady.stem_in == pytest.approx(0.2, rel=0.01)


def test_phase_margin_agrees_with_python_control() -> None:
    """`control.margin` of (26.3 + 9.75 / s) 0.19 / ((0.3 s + 1) (2.7 s + 1)): 63.552 degrees."""
    assert phase_margin(LinearLoop("pi", 26.3, 9.75, tick_s=0.0), DESIGN) == pytest.approx(63.552, abs=0.1)


def test_margins_end_where_hunting_begins() -> None:
    loop = LinearLoop("p_incremental", 1.36)
    left = margins(loop, DESIGN)
    assert left.gain == pytest.approx(2.0, rel=0.03)
    assert not hunts(LinearLoop("p_incremental", 1.36 * left.gain * 0.99), DESIGN)
    assert hunts(LinearLoop("p_incremental", 1.36 * left.gain * 1.03), DESIGN)
