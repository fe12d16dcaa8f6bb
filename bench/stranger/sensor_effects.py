"""The sensor's causes, each in the forms that a stranger could mean by its line in the vocabulary.

A drop-out that repeats the last value is left out: it is a stale sample.
"""

from __future__ import annotations

import numpy as np

from bench.stranger.form import Form, daq, sensor, sign, weather
from bench.stranger.valve import READING_IN, TRAVEL_IN, Valve


def zero_error(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    return sensor(valve, zero_in=sign(rng) * size)


def gain_error(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    return sensor(valve, gain=1.0 + sign(rng) * size)


def gain_and_zero_error(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    return sensor(valve, gain=1.0 + sign(rng) * size, zero_in=sign(rng) * 0.3 * size)


def bow(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    return sensor(valve, bow_in=sign(rng) * size)


def square(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    return sensor(valve, square_in=sign(rng) * size)


def ess(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    """A coil pair that saturates at both ends: an S around mid-travel."""
    return sensor(valve, ess_in=sign(rng) * size)


def straight_drift(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    """The zero moves by `size` in ten minutes."""
    way = sign(rng)
    return weather(valve, READING_IN, lambda time_s: way * size * time_s / 600.0)


def settling_drift(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    way, tau_s = sign(rng), float(rng.uniform(100.0, 400.0))
    return weather(valve, READING_IN, lambda time_s: way * size * (1.0 - np.exp(-time_s / tau_s)))


def slow_wave_drift(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    """Half a day's swing in small: one slow wave over the record."""
    way, period_s = sign(rng), float(rng.uniform(900.0, 2000.0))
    return weather(valve, READING_IN, lambda time_s: way * size * np.sin(2.0 * np.pi * time_s / period_s))


def linkage_play(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    return sensor(valve, play_in=size)


def one_pole(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    return sensor(valve, lag_s=size)


def two_poles(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    return sensor(valve, lag_s=0.5 * size, second_lag_s=0.5 * size)


def regular_refresh(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    return daq(valve, refresh_s=size)


def shared_refresh(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    """The pressure comes from the same slow scan."""
    return daq(valve, refresh_s=size, stale_pressure=True)


def missed_refresh(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    return daq(valve, stale_share=size)


def rounding(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    return daq(valve, step_in=size)


def truncation(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    return daq(valve, step_in=size, truncates=True)


def spikes(valve: Valve, size: float, rng: np.random.Generator) -> Valve:
    return daq(valve, false_share=float(rng.uniform(0.004, 0.02)) if size > 0.0 else 0.0, false_in=size)


def false_zeros(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    return daq(valve, false_share=size, false_kind="value", false_in=0.0)


def full_scale(valve: Valve, size: float, _rng: np.random.Generator) -> Valve:
    return daq(valve, false_share=size, false_kind="value", false_in=1.1 * TRAVEL_IN)


SENSOR_FORMS = (
    Form("lvdt_calibration", "zero", "sensor", "in", 0.0008, 0.05, zero_error),
    Form("lvdt_calibration", "gain", "sensor", "1", 0.001, 0.12, gain_error),
    Form("lvdt_calibration", "both", "sensor", "1", 0.001, 0.12, gain_and_zero_error),
    Form("lvdt_nonlinearity", "bow", "sensor", "in", 0.0008, 0.05, bow),
    Form("lvdt_nonlinearity", "square", "sensor", "in", 0.0008, 0.06, square),
    Form("lvdt_nonlinearity", "ess", "sensor", "in", 0.0008, 0.05, ess),
    Form("lvdt_drift", "straight", "sensor", "in", 0.0008, 0.06, straight_drift),
    Form("lvdt_drift", "settling", "sensor", "in", 0.0008, 0.06, settling_drift),
    Form("lvdt_drift", "wave", "sensor", "in", 0.0008, 0.06, slow_wave_drift),
    Form("linkage_lost_motion", "play", "sensor", "in", 0.001, 0.08, linkage_play),
    Form("sensor_lag", "one_pole", "sensor", "s", 0.02, 2.5, one_pole),
    Form("sensor_lag", "two_poles", "sensor", "s", 0.02, 2.5, two_poles),
    Form("stale_samples", "regular", "sensor", "s", 0.15, 4.0, regular_refresh),
    Form("stale_samples", "shared", "sensor", "s", 0.15, 4.0, shared_refresh),
    Form("stale_samples", "missed", "sensor", "1", 0.1, 0.9, missed_refresh),
    Form("sensor_quantization", "rounding", "sensor", "in", 0.002, 0.06, rounding),
    Form("sensor_quantization", "truncation", "sensor", "in", 0.002, 0.06, truncation),
    Form("sensor_dropouts", "spikes", "sensor", "in", 0.006, 0.4, spikes),
    Form("sensor_dropouts", "zeros", "sensor", "1", 0.0005, 0.03, false_zeros),
    Form("sensor_dropouts", "full_scale", "sensor", "1", 0.0005, 0.03, full_scale),
)
