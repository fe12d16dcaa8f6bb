"""What sticks is judged on unseen rows with numbers that half of the rows may not bend to the time of one slip."""

from __future__ import annotations

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import Recording
from tests.twin.judged import a_record
from twin.diagnose import Settings, diagnose
from twin.fit.case import Case, make_case
from twin.fit.channel import Channel, chain_channel
from twin.fit.fitting import Fit, fit
from twin.fit.space import Cause, make_space
from twin.judge.heldout import fold_weights, refitted
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant
from twin.search.search_rules import SearchRules

DESIGN = DesignModel()


def recorded(name: str, form: str, values: tuple[float, ...]) -> Recording:
    return a_record(Plant(DESIGN, (Inserted(name, effect(name).form(form), values),)))


def fitted(name: str, form: str, values: tuple[float, ...], known: bool = False) -> tuple[Case, Channel, Fit]:
    """A cause and the numbers of the design, from where they are true; `known`: it is a part of the design."""
    one = effect(name)
    inserted = (Inserted(name, one.form(form), values),) if known else ()
    case = make_case([recorded(name, form, values)], DESIGN, inserted)
    channel = chain_channel(case.trials, case.sigma_y)
    numbers = ["deadband", "offset", "compliance", "tau", "rate_limit"]
    causes = [] if known else [Cause(name, one, one.form(form))]
    space = make_space(Plant(DESIGN, inserted), causes, numbers, case.scales)
    own = space.unknowns[len(numbers) :]
    true = np.array([0.0] * len(numbers) + [v / u.unit for v, u in zip(values, own, strict=False)])
    return case, channel, fit(channel, space, [true])


@pytest.mark.parametrize(
    ("name", "form", "values", "known", "stays"),
    [
        ("stiction", "target_sticks", (0.1, 0.0035), False, True),
        ("stiction", "target_sticks", (0.1, 0.0035), True, True),
        ("creep", "one_tail", (0.05, 20.0), False, False),
    ],
)
def test_half_of_the_rows_hardly_bend_the_numbers_of_what_sticks(
    name: str, form: str, values: tuple[float, ...], known: bool, stays: bool
) -> None:
    case, channel, found = fitted(name, form, values, known)
    deviations = found.deviations(max(found.mse, 1.0) ** 0.5)
    again = [refitted([found], [channel], weights)[0] for weights in fold_weights(case.trials)]
    bent = max(float(np.max(np.abs(a.values() - found.values()) / deviations)) for a in again)
    assert (bent < 0.75) is stays


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("name", "form", "values", "said"),
    [("stiction", "target_sticks", (0.1, 0.0035), True), ("creep", "one_tail", (0.15, 8.0), False)],
)
def test_the_answer_says_that_the_held_out_error_is_less_blind(
    name: str, form: str, values: tuple[float, ...], said: bool
) -> None:
    found = diagnose([recorded(name, form, values)], DESIGN, settings=Settings(search=SearchRules(most=1))).diagnosis
    assert [c.name for c in found.causes] == [name]
    assert any("less blind" in note.handled for note in found.data_quality) is said
    assert any("given the measured pressure" in note.handled for note in found.data_quality) is said
