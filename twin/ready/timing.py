"""Which interval a row's command belongs to, where the file does not say.

A shift of up to one row is a nuisance: the pressure (or else the position) decides between "in force before the row"
and "in force after it". In evenly spaced rows a shift by one and a dead time are the same thing, so a delay is never
known better than to that row. Source: interfaces page, recorded runs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from logs.recording import DataNote, Recording
from twin.diagnosis import Cause as Named
from twin.diagnosis import Estimate
from twin.fit.case import Case, make_case
from twin.fit.channel import Channel, chain_channel, pressure_channel
from twin.fit.fitting import fit, starts_of
from twin.fit.space import ACCUSED_SPREAD, Cause, make_space
from twin.model.catalog import effect
from twin.model.plant import Plant
from twin.noise.model import NoiseModel
from twin.ready.thin import look_at

_DELAYING, _DELAY = "dead_time", "delay"
#: With a delay of its own, a timing decides where it leaves so little (mean square, noise = 1) and so much less [nats].
_LEFT, _CLEARLY = 4.0, 12.0


@dataclass(frozen=True, slots=True)
class Slack:
    """By how much a delay may be shorter, or longer, than it looks [s], because nobody knows when commands were."""

    shorter_s: float = 0.0
    longer_s: float = 0.0

    def loosened(self, causes: Sequence[Named]) -> tuple[Named, ...]:
        """The causes, with the interval of a delay reaching as far."""
        return tuple(self._loosened(one) if one.name == _DELAYING else one for one in causes)

    def _loosened(self, cause: Named) -> Named:
        if _DELAY not in cause.parameters:
            return cause
        found = cause.parameters[_DELAY]
        ends = (max(found.ci95[0] - self.shorter_s, 0.0), found.ci95[1] + self.longer_s)
        return replace(cause, parameters={**cause.parameters, _DELAY: Estimate(found.value, ends, found.unit)})


def settled_timing(
    recordings: Sequence[Recording], plant: Plant, noise: NoiseModel
) -> tuple[list[Recording], list[DataNote], Slack]:
    """The recordings with timing "before", all that do not say so shifted by one row where that fits better; a note on
    it, and what it leaves open."""
    unknown = [r for r in recordings if r.command_timing == "unknown"]
    if not unknown:
        return list(recordings), [], Slack()
    after = _fits_after(unknown, plant, noise)
    period_s = max(r.period_s for r in unknown)
    how, other = ("after", "longer") if after else ("before", "shorter")
    note = DataNote(
        f"{', '.join(r.name for r in unknown)}: command timing unknown",
        f"read as in force {how} its row, which fits better; a shift by a row and a dead time are the same thing, so "
        f"the interval of a delay holds one {period_s:.3g} s {other}, too",
    )
    settled = [_said(_shifted(r) if after else r) if r.command_timing == "unknown" else r for r in recordings]
    return settled, [note], Slack(longer_s=period_s) if after else Slack(shorter_s=period_s)


def _said(recording: Recording) -> Recording:
    return replace(recording, command_timing="before")


def _shifted(recording: Recording) -> Recording:
    """Each command one row later."""
    return replace(recording, command=np.concatenate([recording.command[:1], recording.command[:-1]]))


def _fits_after(recordings: Sequence[Recording], plant: Plant, noise: NoiseModel) -> bool:
    """Whether commands fit better when they are in force after their rows.

    To a converter with a delay a row more always looks better: so each timing first gets a delay of its own, which
    decides where rows come unevenly. Where they do not, the timing that does without a delay is the better one.
    """
    cases = [_look([change(r) for r in recordings], plant, noise) for change in (_said, lambda r: _said(_shifted(r)))]
    if not any(one.effect == _DELAYING for one in plant.inserted):
        before, after = (_left_with_delay(case) for case in cases)
        gained = 0.5 * _channel(cases[0]).rows * abs(np.log(before / after))
        if min(before, after) < _LEFT and gained > _CLEARLY:
            return after < before
    before, after = (_left(case) for case in cases)
    return after < before


def _look(recordings: Sequence[Recording], plant: Plant, noise: NoiseModel) -> Case:
    return look_at(make_case(recordings, plant.design, plant.inserted, noise=noise))[0]


def _channel(case: Case) -> Channel:
    if case.sigma_p is None:
        return chain_channel(case.trials, case.sigma_y)
    return pressure_channel(case.trials, case.sigma_p)


def _left(case: Case) -> float:
    """Mean squared residual of the design as it is, noise = 1."""
    channel = _channel(case)
    residuals = channel.residuals(case.base)
    return float(residuals @ residuals) / max(channel.rows, 1.0)


def _left_with_delay(case: Case) -> float:
    """... with a delay and a lag of the converter fitted."""
    delay = Cause(_DELAYING, effect(_DELAYING), effect(_DELAYING).form("pure_delay"))
    space = make_space(case.base, (delay,), ("ep_tau",), case.scales, ACCUSED_SPREAD)
    return max(fit(_channel(case), space, starts_of(space), refine=2).mse, 1e-12)
