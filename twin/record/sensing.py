"""What the look of the readings says before any model is tried, and what of it enters the models.

False readings are kept from every fit; a coarse resolution is part of the noise. A slow refresh is a candidate like any
other effect (its trajectory is simulated), so that it competes with lags.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import median_filter

from control.design import DesignModel
from logs.recording import Recording
from twin.diagnosis import EffectTest, Estimate
from twin.events.dropouts import SIGMAS
from twin.events.evidence import Evidence
from twin.events.refresh import refreshed_together
from twin.events.scan import ON_CHANGE, Events, scan_events
from twin.events.tails import together
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.plant import Inserted, Plant
from twin.noise.lattice import rounding_error
from twin.noise.model import NoiseModel
from twin.record.held_noise import HELD_NATS
from twin.record.no_motion import jumps_of, no_motion
from twin.record.recorder import rounded_by_recorder

#: A reading that is false less often than this is ordinary noise with a tail.
_LEAST_RATE = 2e-4
#: ... unless false readings alone make an error of so many times the noise.
_LOUD = 3.0
#: A step is an effect when it is coarser than the noise and than this share of travel.
_LEAST_STEP = 1e-3
#: Held readings are an effect of their own when they are this share of all.
_HELD = 0.3
#: ... or this share, where far fewer than would by chance (this share of them) are held twice running.
_CLOCKED, _AGAIN = 0.05, 0.5
#: ... or this share, where so many of them are held once more in the next row.
_HUNG, _ON = 0.02, 0.5
#: Bands of two recordings are one band up to this ratio.
_ALIKE = 1.2


@dataclass(frozen=True, slots=True)
class Sensing:
    """Events of all recordings. `accepted`: estimates of every accepted event effect; `step`: the resolution.

    `uneven`: by how much more codes that never occur make the reading err. `band`: by how much a reading that is
    reported on change has to change; 0 for one that is polled. `recorded`: whether the recorder made the step, and not
    the gauge. `together`: whether the pressure is held in the same rows as the position.
    """

    events: tuple[Events, ...]
    accepted: dict[str, dict[str, Estimate]]
    step: float
    uneven: float = 1.0
    band: float = 0.0
    recorded: bool = False
    together: bool = False

    @property
    def coarseness(self) -> float:
        """The step whose rounding would make as large an error [position]."""
        return self.uneven * self.step

    def inserted(self) -> tuple[Inserted, ...]:
        """What of the accepted events a model can repeat: the resolution of the reading."""
        if self.band > 0.0:
            return (Inserted("sensor_quantization", effect("sensor_quantization").form("on_change"), (self.band,)),)
        if "sensor_quantization" not in self.accepted:
            return ()
        return (Inserted("sensor_quantization", effect("sensor_quantization").forms[0], (self.step,)),)

    def beside(self, plant: Plant) -> Plant:
        """`plant` with every accepted event: what is named and was not fitted gets the first form that the estimates
        are enough for. A false reading is chance and a held one lasts as long as it is seen to: they move nothing."""
        seen = plant.having(self.inserted())
        names = {one.effect for one in seen.inserted}
        return seen.having([_as_estimated(*event) for event in self.accepted.items() if event[0] not in names])

    @property
    def sharp(self) -> bool:
        """Whether the reading is in coarse steps, all of its codes occur, and it is new in every row."""
        in_steps = "sensor_quantization" in self.accepted or self.recorded
        return in_steps and self.uneven < 1.0 + 1e-9 and not self.held

    @property
    def held(self) -> bool:
        """Whether readings are seen to be new less often than they are polled."""
        return "stale_samples" in self.accepted or self.band > 0.0

    @property
    def bad_rows(self) -> list[np.ndarray]:
        """False position readings per recording."""
        return [e.false_position for e in self.events]


def sense(recordings: Sequence[Recording], noise: NoiseModel, design: DesignModel) -> Sensing:
    """Scans all recordings and accepts what all of them together leave no doubt about.

    What a stem of that design could do is no false reading.
    """
    travel = design.travel
    events = tuple(_widened(scan_events(r, noise), r, noise, design.rate_limit) for r in recordings)
    accepted: dict[str, dict[str, Estimate]] = {}
    rows = sum(r.n for r in recordings)
    false = sum(int(e.false_position.sum()) for e in events)
    drop = _strongest(events, "sensor_dropouts")
    often = false >= 3 and false / rows > _LEAST_RATE
    enough = (drop.found and often) or _loud(recordings, events, noise)
    apart = enough and not together([e.tail for e in events]).heavy
    if apart and no_motion(recordings, [e.false_position for e in events], noise, design):
        accepted["sensor_dropouts"] = dict(drop.estimates)
    held_together = any(refreshed_together(r) for r in recordings)
    band = _band(events, max(_LEAST_STEP * travel, 2.0 * noise.position.sigma))
    if band > 0.0:
        # what is reported on change repeats, and is neither late nor in steps
        accepted["sensor_quantization"] = {"step": _strongest(events, ON_CHANGE).estimates["band"]}
        return Sensing(events, accepted, 0.0, band=band, together=held_together)
    quantization = _strongest(events, "sensor_quantization")
    step = quantization.estimates["step"].value if "step" in quantization.estimates else 0.0
    in_steps = quantization.found and step > max(_LEAST_STEP * travel, _noise_without(noise, step))
    recorded = in_steps and rounded_by_recorder(recordings, step, travel)
    if in_steps and not recorded:
        accepted["sensor_quantization"] = dict(quantization.estimates)
    stale = _strongest(events, "stale_samples")
    if stale.found and stale.log_likelihood_ratio > HELD_NATS and _slow_refresh(stale):
        accepted["stale_samples"] = {"period": stale.estimates["refresh_period"]}
    uneven = _uneven(recordings, step) if "sensor_quantization" in accepted else 1.0
    return Sensing(events, accepted, step, uneven, recorded=recorded, together=held_together)


def _as_estimated(name: str, estimates: Mapping[str, Estimate]) -> Inserted:
    """The event's effect with the estimated values. Every event's effect has such a form (a test looks at them all)."""
    forms = effect(name).forms
    form = next(f for f in forms if all(p.name in estimates for p in f.parameters))
    return Inserted(name, form, tuple(estimates[p.name].value for p in form.parameters))


def _slow_refresh(stale: Evidence) -> bool:
    """Whether readings are held by a slow refresh: so often; or, less often, never twice running as lost ones are, or
    nearly always, as those of a converter that hangs."""
    hold, again = stale.estimates["hold_fraction"].value, stale.estimates["again"].ci95
    return hold > _HELD or (hold > _CLOCKED and again[1] < _AGAIN * hold) or (hold > _HUNG and again[0] > _ON)


def _band(events: Sequence[Events], least: float) -> float:
    """The band of readings that are reported on change, in all recordings alike; 0 where they are not."""
    seen = [e.evidence[ON_CHANGE] for e in events]
    if not all(e.found for e in seen):
        return 0.0
    bands = [e.estimates["band"].value for e in seen]
    return min(bands) if least < min(bands) and max(bands) < _ALIKE * min(bands) else 0.0


def _uneven(recordings: Sequence[Recording], step: float) -> float:
    """RMS of the rounding error over that of a converter with all its codes."""
    return float(np.sqrt(12.0 * rounding_error(np.concatenate([r.position for r in recordings]), step)))


def _loud(recordings: Sequence[Recording], events: Sequence[Events], noise: NoiseModel) -> bool:
    """Whether the false readings, few as they are, make an error far above the noise of all readings together."""
    jumps = np.concatenate(jumps_of(recordings, [e.false_position for e in events]))
    return float(np.sum(jumps**2)) > _LOUD**2 * noise.position.sigma**2 * sum(r.n for r in recordings)


def _strongest(events: Sequence[Events], name: str) -> Evidence:
    return max((e.evidence[name] for e in events), key=lambda one: one.log_likelihood_ratio)


def smallest_seen(noise: NoiseModel, scales: Scales, travel: float) -> tuple[EffectTest, ...]:
    """What the readings themselves would have to show: the smallest false reading and step that are named."""
    step, sigma = max(_LEAST_STEP * travel, noise.position.sigma), noise.position.sigma
    seen = (("sensor_dropouts", "size", SIGMAS * sigma), ("sensor_quantization", "step", step))
    return tuple(EffectTest(name, True, "", parameter, size, scales.position_unit) for name, parameter, size in seen)


def _noise_without(noise: NoiseModel, step: float) -> float:
    """Noise of the position without the part that the reading's step makes."""
    return float(np.sqrt(max(noise.position.sigma**2 - step**2 / 12.0, 0.0)))


def _widened(events: Events, recording: Recording, noise: NoiseModel, fastest: float) -> Events:
    """Where false readings were found, those too that fell into a motion: further from the median of their seven
    neighbours than a stem at full speed could be."""
    if not events.evidence["sensor_dropouts"].found:
        return events
    known = np.isfinite(recording.position)
    rows = np.arange(recording.n)
    filled = np.interp(rows, rows[known], recording.position[known])
    reach = 2.5 * fastest * recording.period_s + 8.0 * noise.position.sigma
    far = known & (np.abs(filled - median_filter(filled, 7, mode="mirror")) > reach)
    return replace(events, false_position=events.false_position | far)
