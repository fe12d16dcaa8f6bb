"""A recording that is given twice is used once, and shows no noise; two recordings of their own are left alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from logs.recording import FloatArray, Recording
from tests.twin.noise.test_noise import DT, SIGMA, coloured, runs
from twin.noise.copies import copied, used_once
from twin.noise.model import estimate_noise
from twin.noise.repeats import find_repeats


def digits(values: FloatArray, count: int) -> FloatArray:
    """The values as a file with so many significant digits has them."""
    return np.array([float(f"{value:.{count}g}") for value in values])


def exported(one: Recording) -> Recording:
    """The recording as its own export brings it back: digits cut, times from zero, without pressure and story."""
    return replace(
        one,
        name="export.csv",
        time_s=digits(one.time_s - one.time_s[0] + 3.0, 6),
        position=digits(one.position, 5),
        pressure=None,
        meta={},
    )


def test_a_file_named_twice_is_used_once_with_a_note() -> None:
    [one] = runs([SIGMA])
    kept, notes = used_once([one, one])
    assert kept == [one]
    assert notes[0].what == f"{one.name} holds the same readings as {one.name}"
    assert notes[0].rows == one.n


@pytest.mark.parametrize("first", [0, 1])
def test_of_a_run_and_its_export_the_run_stays_whichever_comes_first(first: int) -> None:
    [one] = runs([SIGMA])
    pair = [one, exported(one)]
    kept, notes = used_once([pair[first], pair[1 - first]])
    assert [k.pressure is not None for k in kept] == [True]
    assert len(notes) == 1


def test_repeats_are_no_copies() -> None:
    both = runs([SIGMA, SIGMA], memory=0.7)
    kept, notes = used_once(both)
    assert (len(kept), notes) == (2, [])
    # nor are those whose noise is far below a coarse reading's step, as long as there is any
    coarse = [replace(r, position=np.round(r.position / SIGMA) * SIGMA) for r in runs([0.3 * SIGMA, 0.3 * SIGMA])]
    assert len(used_once(coarse)[0]) == 2


def test_the_same_readings_at_other_times_are_another_record() -> None:
    [one] = runs([SIGMA])
    assert len(used_once([one, replace(one, time_s=1.5 * one.time_s)])[0]) == 2
    assert len(used_once([one, replace(one, time_s=one.time_s + 1000.0)])[0]) == 1


def test_what_never_changes_is_no_copy() -> None:
    assert not copied(np.ones(50), np.ones(50))
    assert not copied(np.full(50, np.nan), np.full(50, np.nan))


def test_a_record_pasted_behind_itself_repeats_nothing() -> None:
    [one] = runs([SIGMA])

    def behind(position: FloatArray) -> Recording:
        twice = {name: np.tile(getattr(one, name), 2) for name in ("command", "pressure")}
        times = np.concatenate([one.time_s, one.time_s + one.duration_s + DT])
        return replace(one, time_s=times, position=np.concatenate([one.position, position]), **twice)

    assert find_repeats([behind(one.position)]) == []
    assert len(find_repeats([behind(one.position + coloured(one.n, 0.0, SIGMA, 7))])) == 1


def test_an_overlap_is_no_repeat_and_leaves_the_noise_as_it_is() -> None:
    [one] = runs([SIGMA])
    parts = [one.slice(0, 1500), one.slice(300, one.n)]
    assert find_repeats(parts) == []
    assert estimate_noise(parts).position.sigma == pytest.approx(SIGMA, rel=0.15)
    own = replace(parts[1], position=parts[1].position + coloured(parts[1].n, 0.0, SIGMA, 7))
    assert len(find_repeats([parts[0], own])) == 1
    assert own.period_s == pytest.approx(DT)
