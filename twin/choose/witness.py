"""The stem as a second witness of the pressure: a gauge may wander where the pressure does not.

What a gauge reads beyond the converter's model is either air, which moves the stem, or the gauge. Where a valve that is
driven by the model's pressure leaves far less of the position than one that is driven by the reading, it was the gauge.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from logs.recording import DataNote
from twin.fit.case import Case
from twin.fit.channel import position_channel, pressure_fine
from twin.fit.fitting import Fit, fit, starts_of
from twin.fit.in_steps import in_steps
from twin.fit.space import ACCUSED_SPREAD, make_space
from twin.fit.trial import Trial
from twin.model.plant import Plant
from twin.search.search_rules import SLIGHT

#: Of what the re-tuned design leaves of the position when it is driven by the reading: the most that it leaves when
#: driven by the model; and by how many noise variances that is less, at least. By how many it may leave more, and
#: does as well.
_FOLLOWS, _CLEARLY, _AS_WELL = 0.75, 0.5, 0.1


def driven_by_model(plant: Plant, trials: Sequence[Trial]) -> tuple[Trial, ...]:
    """The trials with the pressure that `plant` makes of their commands, whatever was read."""
    return tuple(trial.with_pressure(pressure_fine(plant, trial)) for trial in trials)


def gauge_wanders(read: float, modelled: float, believing: float = 0.0) -> bool:
    """Whether the stem followed the model's pressure and not what was read, by what each leaves (`left_of_position`).

    `read`: driven by what stands out of the reading's noise; `believing`: by all that the smoothed reading has, 0 where
    nobody asks. Where the stem denies the latter, and goes with the model as well as with what stands out, what is left
    is noise.
    """
    return _denies(modelled, read) or (modelled <= read + _AS_WELL and _denies(modelled, believing))


def gauge_lies(found: float, designed: float) -> bool:
    """Whether the stem went as if the converter were its design, although the reading has a cause that explains it.

    `found`: the least that is left when the reading, or the converter's model with that cause, drives the valve;
    `designed`: when the converter without it does. What the gauge does itself, a lag of its tube, looks in its reading
    like a converter's cause. Only where the valve passes for healthy when the design drives it: what is wrong behind
    the pressure may by chance make up for a part of what is wrong before it.

    To be asked with the numbers as they are, too: what a gauge reads too high or too steep re-tuned numbers take over,
    but that those and a fault of the converter cancel to the noise is no accident.
    """
    return designed <= SLIGHT and _denies(designed, found)


def still_denied(case: Case, trials: Sequence[Trial], found: Fit) -> bool:
    """Whether the stem denies what was read once the likeliest cause behind the pressure is `found`.

    `trials`: driven by the model. A stem that sticks and slips goes by the first touch of its edges: noise that hardly
    stands out takes it elsewhere, and without its cause either pressure leaves as much.
    """
    if found.mse <= SLIGHT:
        return False
    channel = in_steps(case, position_channel(trials, case.sigma_y))
    again = fit(channel, found.space, starts_of(found.space, [found], channel.recordings), refine=2)
    return _denies(again.mse, found.mse)


def _denies(followed: float, other: float) -> bool:
    """Whether one pressure leaves clearly less of the position than another, in noise variances."""
    return followed < _FOLLOWS * other and followed < other - _CLEARLY


def gauge_note(case: Case, missed: float, against: Sequence[str] = ()) -> DataNote:
    """What to say of it. `missed`: mean square that the design leaves of the reading, noise = 1; `against`: causes that
    the reading has, and the stem denies."""
    causes = " and ".join(name.removeprefix("parameter:") for name in against)
    like = f" (by itself it would be {causes})" if against else ""
    what = f"the pressure reading strays in a way that the stem does not follow{like}"
    held = "the position is held to the pressure that the converter's model makes of the commands"
    told = f"taken as the gauge's own error: {held}; another gauge on the same line would tell"
    if missed <= SLIGHT and not against:
        what, told = "the pressure reading is noisier than what moved the stem", f"its noise moves nothing: {held}"
    return DataNote(what=what, handled=told, rows=sum(r.n for r in case.recordings), first_row=None)


def left_of_position(case: Case, trials: Sequence[Trial]) -> float:
    """Mean square that the design leaves of the position with its numbers re-tuned, noise = 1."""
    channel = in_steps(case, position_channel(trials, case.sigma_y))
    space = make_space(case.base, (), channel.numbers, case.scales, ACCUSED_SPREAD)
    return fit(channel, space, [np.zeros(len(space.unknowns))]).mse


def missed_of_position(case: Case, trials: Sequence[Trial]) -> float:
    """Mean square that the design leaves of the position with its numbers as they are, noise = 1."""
    channel = in_steps(case, position_channel(trials, case.sigma_y))
    return fit(channel, make_space(case.base, (), (), case.scales), [np.zeros(0)]).mse
