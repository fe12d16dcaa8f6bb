"""The noise of readings that are not new in every row: held ones, and such as are reported on change."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from logs.recording import Recording
from twin.events.scan import scan_events
from twin.noise.lattice import lattice_step
from twin.noise.model import NoiseModel, estimate_noise

#: Evidence that leaves no doubt about held readings [nats].
HELD_NATS = 100.0
#: Share of readings that repeat the one before, above which the noise is taken from the others.
_MOSTLY_HELD = 0.4
#: Noise in steps of a reading, up to which it is that of the steps.
_ROUNDING = 0.3
#: By how much reporting on change enlarges the noise: 1 for a quick stem, and the largest of ten is 1.5.
_FAVOURED = 1.5


def noise_of_refreshed(recordings: Sequence[Recording], noise: NoiseModel, repeats: bool = True) -> NoiseModel:
    """The noise with that of the position taken from fresh readings only, where most readings repeat the one before.

    Repeated values look still and free of noise; `noise` is returned as it is where the readings are fresh. In coarse
    steps any reading repeats: there it takes more to call them held, and what is in the next row is the next step.
    `repeats`: see `estimate_noise`; readings that were not refreshed at the same instants differ while the stem moves.
    """
    stale = [scan_events(r, noise).evidence["stale_samples"] for r in recordings]
    step = lattice_step(np.concatenate([r.position for r in recordings])) or 0.0
    least = HELD_NATS if noise.position.sigma <= _ROUNDING * step else 0.0
    held = [e.estimates["hold_fraction"].value if e.found and e.log_likelihood_ratio > least else 0.0 for e in stale]
    if min(held) <= _MOSTLY_HELD:
        return noise
    return replace(noise, position=estimate_noise([_fresh(r) for r in recordings], repeats).position)


def as_reported(noise: NoiseModel) -> NoiseModel:
    """The noise of a position that is reported on change: it is reported when way and noise together pass the band, so
    that noise on the way's side comes first. Of a stem that creeps past it the largest of many is reported."""
    position = noise.position
    return replace(noise, position=replace(position, sigma=_FAVOURED * position.sigma))


def _fresh(recording: Recording) -> Recording:
    """The rows whose position differs from the row before."""
    new = np.flatnonzero(np.diff(recording.position, prepend=np.nan) != 0.0)
    pressure = None if recording.pressure is None else recording.pressure[new]
    return Recording(recording.name, recording.time_s[new], recording.command[new], recording.position[new], pressure)
