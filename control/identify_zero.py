"""A position whose zero is far from fully open: the reading at the open stop, where the records show that stop.

An LVDT reads 10 to 24 mm for a stroke of 14 mm, or -7 to 7 mm: its zero is where somebody has put it. A stem that
merely stays away from fully open reads the same way. The stop tells them apart: pressed against it the stem stays where
it is, however far the pressure falls, and no valve that could go on does that.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from control.identify_model import A1, A2, K1, K2, TRAVEL
from control.identify_readings import fast_noise
from control.identify_starts import NEVER
from control.identify_track import Track, reach_of, thinned
from control.identify_tracks import FEWEST_ROWS, cleaned, drive_of, tracks_of
from control.identify_valve import Freedom, ValveFit, fit_valve, refitted
from logs.recording import DataNote, Recording
from logs.spoken import of_its_file

#: How far from 0 the lowest reading has to be to be looked at, as a share of what the stem moved.
OFF = 0.05
#: The stop is there if with it the fit leaves less than this part of what it leaves without.
_STOPPED = 0.5
#: Stems move so many times what they moved before a stop that is moved away can be met.
_FAR_OFF = 10.0
#: Readings about the lowest that are taken for the stop's at first, as a share of what the stem moved.
_NEAR = 0.02
#: Ways of the stem, in noises, below which nothing moves.
_MOVES = 20.0


def zeroed(recordings: Sequence[Recording], far: float = OFF) -> list[Recording]:
    """The recordings with the reading at the open stop taken off all positions and targets, and that said; as they
    are where it is nearer to zero than the share `far` of what the stem moves, or where no stop shows.

    The recordings are of one valve, in the same units.
    """
    zero = zero_of(recordings, far)
    return list(recordings) if zero is None else [_less(each, zero) for each in recordings]


def zero_of(recordings: Sequence[Recording], far: float = OFF) -> float | None:
    """The reading at the open stop [unit of the records], where it is far from 0; None where nothing says so."""
    tracks = _tracks(recordings)
    if not tracks:
        return None
    reach = reach_of(tracks)
    noise = max(fast_noise(t.position[t.good]) for t in tracks)
    if reach.span <= 0.0 or reach.width <= _MOVES * noise or abs(reach.low) <= far * reach.width:
        return None
    readings = np.concatenate([t.position[t.good] for t in tracks])
    low = float(np.median(readings[np.abs(readings - reach.low) < _NEAR * reach.width]))
    moved = [_less_track(track, low) for track in tracks]
    stopped, freedom = fit_valve(moved)
    if reach.low > 0.0:  # no stem goes below fully open, whatever else is true
        free, _ = fit_valve(tracks)
        if stopped.cost > _STOPPED * min(free.cost, _cost_unstopped(stopped, freedom, moved, _FAR_OFF * reach.width)):
            return None
    return low + _off(stopped, moved)


def _tracks(recordings: Sequence[Recording]) -> list[Track]:
    tracks, unsaid = list[Track](), list[str]()
    for each in recordings:
        if each.n >= FEWEST_ROWS and float(np.ptp(each.command)) > 0.0:
            clean = cleaned(each, unsaid)
            stage, fine_s, fine = drive_of(clean, 0.3, unsaid)
            tracks += [thinned(t) for t in tracks_of(clean, fine_s, fine, stage, unsaid)]
    return tracks


def _cost_unstopped(fit: ValveFit, freedom: Freedom, tracks: Sequence[Track], by: float) -> float:
    """What the best fit from there would cost if the stop were further down `by` so much: curves and readings move
    up instead.

    Where the stem only stays away from fully open that loses nothing, however far off the free fit has ended.
    """
    numbers = fit.numbers.copy()
    numbers[A1] -= by / numbers[K1]
    numbers[A2] -= by / numbers[K2]
    numbers[TRAVEL] = min(numbers[TRAVEL] + by, NEVER)
    higher = replace(fit, numbers=numbers, play_starts=fit.play_starts + by)
    return refitted([_less_track(track, -by) for track in tracks], higher, freedom).cost


def _off(fit: ValveFit, tracks: Sequence[Track]) -> float:
    """What the readings still are off by, where the model is at the open stop."""
    pairs = zip(tracks, fit.predict(tracks), strict=True)
    rest = np.concatenate([(t.position - x)[t.good & (x <= 1e-6 * reach_of(tracks).width)] for t, x in pairs])
    return float(np.median(rest)) if rest.size >= FEWEST_ROWS else 0.0


def _less_track(track: Track, zero: float) -> Track:
    return replace(track, position=track.position - zero, start=track.start - zero)


def _less(recording: Recording, zero: float) -> Recording:
    said = of_its_file(recording).text(zero, recording.position_unit, 4)
    note = DataNote(
        f"the position reads {said} where the stem is fully open",
        "taken for its zero and taken off; give the range of the signal (--units) if that is not so",
        recording.n,
    )
    target = None if recording.target is None else recording.target - zero
    return replace(recording, position=recording.position - zero, target=target, notes=(*recording.notes, note))
