"""The arrays that a report draws: only readings recognised as false are left out of its lines."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import Recording
from twin.fit.trial import make_trial
from twin.write import said_of_the_model, series_of


def test_only_false_readings_are_not_drawn() -> None:
    time_s = np.delete(np.arange(0.0, 60.0, 0.1), slice(300, 310))
    command = np.where(time_s < 30.5, 6.0, 10.0)  # a step at a time that nobody knows
    one = Recording("r", time_s, command, np.full(time_s.size, 0.1))
    false = np.arange(time_s.size) == 200
    trial = make_trial(one, 0.05, false)
    assert np.count_nonzero(~trial.use_y) > 50  # the settling and what the step moves
    rows = (np.zeros(one.n),)
    outcome = SimpleNamespace(
        recordings=(one,),
        model=DesignModel(),
        before=rows,
        retuned=rows,
        after=rows,
        pressures=((rows[0] + 1.0,), (rows[0] + 2.0,)),
        gap=SimpleNamespace(after=np.where(trial.use_y, 0.0, np.nan)),
        result=SimpleNamespace(case=SimpleNamespace(trials=(trial,))),
    )
    series = series_of(outcome)  # type: ignore[arg-type]
    assert np.array_equal(np.isnan(series.percent(series.position)), false)
    assert np.array_equal(series.heldout, trial.use_y)
    assert series.pressure_before is not None and series.pressure_after is not None
    assert (series.pressure_before == 1.0).all() and (series.pressure_after == 2.0).all()


@pytest.mark.parametrize(
    ("verdict", "after", "warned"),
    [("unexplained", 4.0, True), ("unexplained", 9.0, False), ("unexplained", None, False), ("parameter", 4.0, False)],
)
def test_numbers_that_make_up_for_something_unknown_are_not_recommended(
    verdict: str, after: float | None, warned: bool
) -> None:
    known = SimpleNamespace(verdict=verdict, statement="So it is.", gap=SimpleNamespace(before=9.0, after=after))
    first, *more = said_of_the_model(known).splitlines()  # type: ignore[arg-type]
    assert first == "So it is."
    assert bool(more) is warned
    assert all("nearer to the design given" in line for line in more)
