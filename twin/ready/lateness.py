"""Commands that take effect a little after the time of their row: timing of the record, not a dead time of the valve.

A file gives a command's time to the row at best; polling adds jitter. A delay of a small part of the sampling period,
which together with the converter's lag accounts for all of the pressure's error, is put into the base model, so that
nobody is blamed for it. Longer delays, and those that leave something, are left to the search;
nor is there one where another lag alone does, and the delay alone does not.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from logs.recording import DataNote, Recording
from twin.fit.case import Case
from twin.fit.channel import Channel, pressure_channel
from twin.fit.fitting import fit
from twin.fit.space import ACCUSED_SPREAD, Cause, make_space
from twin.model.catalog import effect
from twin.model.plant import Inserted

#: Of the sampling period: a shorter delay is timing.
TIMING = 0.2
#: Mean squared residual, noise = 1, that may be left; and by how many nats the delay has to fit better.
_LEFT, _CLEARLY = 4.0, 12.0
#: ... and of the design as it is, below which nobody would be blamed for anything.
_BLAMED = 1.05


def late_commands(case: Case) -> tuple[tuple[Inserted, ...], list[DataNote]]:
    """The delay as an effect of the base model, with a note on it; nothing where there is none, or no pressure."""
    if case.sigma_p is None or any(i.effect == "dead_time" for i in case.base.inserted):
        return (), []
    channel = pressure_channel(case.trials, case.sigma_p)
    if fit(channel, make_space(case.base, (), (), case.scales), [np.zeros(0)]).mse < _BLAMED:
        return (), []
    form = effect("dead_time").form("pure_delay")
    late = Cause("dead_time", effect("dead_time"), form)
    with_lag = make_space(case.base, (), ("ep_tau",), case.scales, ACCUSED_SPREAD)
    with_both = make_space(case.base, (late,), ("ep_tau",), case.scales, ACCUSED_SPREAD)
    lag = fit(channel, with_lag, [np.zeros(1)])
    if lag.mse < _BLAMED and not _does_alone(channel, case, late, lag.mse):
        return (), []
    start = np.array([lag.z[0], 0.05 * _period_s(case.recordings) / with_both.unknowns[1].unit])
    both = fit(channel, with_both, [start])
    delay_s = float(both.values()[1])
    gained = 0.5 * channel.rows * np.log(max(lag.mse, 1e-12) / max(both.mse, 1e-12))
    if not 0.0 < delay_s < TIMING * _period_s(case.recordings) or both.mse > _LEFT or gained < _CLEARLY:
        return (), []
    note = DataNote(
        f"commands take effect {1e3 * delay_s:.1f} ms after their rows' time, a small part of the sampling period",
        "taken as timing of the record, not as dead time",
    )
    return (Inserted("dead_time", form, (delay_s,)),), [note]


def _does_alone(channel: Channel, case: Case, late: Cause, least: float) -> bool:
    """Whether the delay leaves no more than `least` with the lag of the design: of two lags, one may be shorter."""
    space = make_space(case.base, (late,), (), case.scales)
    start = np.array([0.05 * _period_s(case.recordings) / space.unknowns[0].unit])
    return fit(channel, space, [start]).mse <= least


def _period_s(recordings: Sequence[Recording]) -> float:
    return float(np.median([r.period_s for r in recordings]))
