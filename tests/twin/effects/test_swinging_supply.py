"""A supply that swings with its compressor."""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import FloatArray, Recording
from tests.twin.judged import a_record, judged
from twin.fit.case import make_case
from twin.fit.channel import pressure_channel
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.place import Place
from twin.model.plant import Inserted, Plant, pressure_response
from twin.model.timegrid import make_grid
from twin.search.candidates import effect_causes

D = DesignModel()
EFFECT = effect("supply_saturation")
#: Supply, cosine and sine of its swing [psi], period [s].
WAVE = (11.2, 0.5, -0.9, 70.0)


def plant(form: str, values: tuple[float, ...] = WAVE) -> Plant:
    return Plant(D, (Inserted("supply_saturation", EFFECT.form(form), values),))


def commands(n: int = 900) -> tuple[FloatArray, FloatArray]:
    time_s = np.arange(n) * 0.2
    return time_s, 9.0 + 4.0 * np.sin(2.0 * np.pi * time_s / 45.0)


def pressure(one: Plant, place: Place | None = None, n: int = 900, begins: int = 0) -> FloatArray:
    time_s, command = commands(n)
    grid = make_grid(time_s[begins:] - time_s[begins], 0.01)
    c = one.coefficients(float(grid.time_s[-1]), place)
    return pressure_response(c, grid, command[begins:], float(command[begins]))[grid.offsets]


def explicit(form: str) -> FloatArray:
    """The same in explicit steps of a millisecond."""
    time_s, command = commands()
    supply, cosine, sine, period_s = WAVE
    p, out = command[0], [command[0]]
    for i in range(1, time_s.size):
        for k in range(200):
            angle = 2.0 * pi * (time_s[i - 1] + 0.001 * (k + 1)) / period_s
            highest = supply + cosine * cos(angle) + sine * sin(angle)
            goal = command[i] if form == "swinging_cut_off" else min(command[i], highest)
            p += 0.001 / D.ep_tau_s * (goal - p)
            p = min(p, highest) if form == "swinging_cut_off" else p
        out.append(p)
    return np.array(out)


@pytest.mark.parametrize("form", ["swinging", "swinging_cut_off"])
def test_the_pressure_is_held_back_as_the_supply_swings(form: str) -> None:
    found, expected = pressure(plant(form)), explicit(form)
    assert np.abs(found - expected).max() < 0.02
    assert np.abs(found - pressure(Plant(D))).max() > 1.0


@pytest.mark.parametrize("form", ["swinging", "swinging_cut_off"])
def test_a_later_part_of_a_recording_has_the_swing_of_its_time(form: str) -> None:
    whole = pressure(plant(form))
    part = pressure(plant(form), Place(since_s=100.0, span_s=180.0, within_s=100.0), begins=500)
    settled = slice(100, None)
    assert np.allclose(part[settled], whole[500:][settled], atol=1e-3)
    assert not np.allclose(pressure(plant(form), begins=500)[settled], whole[500:][settled], atol=0.1)


def test_behind_a_booster_it_is_the_supply_of_the_booster() -> None:
    """Of one that swings the pressure is between those of its lowest and its highest, and theirs where it is so."""
    booster = Inserted("ep_rate_limit", effect("ep_rate_limit").form("orifices"), (0.1, 0.15, 1.5))

    def behind(form: str, *values: float) -> FloatArray:
        return pressure(plant(form, values).having((booster,)))

    low, high = behind("cut_off", 10.0), behind("cut_off", 12.0)
    np.testing.assert_allclose(behind("swinging_cut_off", 10.0, 0.0, 0.0, 180.0), low, atol=1e-12)
    swings = behind("swinging_cut_off", 11.0, 0.0, 1.0, 180.0)
    assert np.all((swings >= low - 1e-9) & (swings <= high + 1e-9))
    at_s = commands()[0]
    top, bottom = np.abs(at_s - 45.0) < 12.0, np.abs(at_s - 135.0) < 12.0
    assert np.abs(swings - high)[top].max() < 0.1 < np.abs(swings - low)[top].max()
    assert np.abs(swings - low)[bottom].max() < 0.1 < np.abs(swings - high)[bottom].max()


def test_it_stands_trial_on_several_recordings_too() -> None:
    """Each may have begun as the compressor did; those with a clock in common tell how far apart they are."""
    record = a_record(plant("swinging_cut_off"))
    channel = pressure_channel(make_case([record, record], D, ()).trials, 0.01)
    assert {"swinging", "swinging_cut_off"} <= {c.form.name for c in effect_causes(channel) if c.form is not None}


def test_its_starts_are_read_from_where_the_pressure_is_held_back() -> None:
    time_s, command = commands()
    noise = np.random.default_rng(2).normal(0.0, 0.01, time_s.size)
    seen = explicit("swinging_cut_off") + noise
    read = Recording("valve", time_s, command, np.zeros(time_s.size), seen)
    form = EFFECT.form("swinging_cut_off")
    assert form.starts_for is not None
    starts = form.starts_for([read], Scales())
    assert any(np.allclose(one, WAVE, rtol=0.05, atol=0.1) for one in starts)
    some = np.where(np.arange(time_s.size) % 7 == 3, np.nan, seen)
    gaps = form.starts_for([Recording("valve", time_s, command, read.position, some)], Scales())
    assert any(np.allclose(one, WAVE, rtol=0.05, atol=0.1) for one in gaps)
    free = Recording("valve", time_s, command, np.zeros(time_s.size), pressure(Plant(D)) + noise)
    assert list(form.starts_for([free], Scales())) == []
    unread = Recording("valve", time_s, command, np.zeros(time_s.size))
    assert list(form.starts_for([unread], Scales())) == []


@pytest.mark.thorough
def test_a_supply_that_swings_is_found() -> None:
    result, _ = judged(a_record(plant("swinging_cut_off", (11.0, 0.3, 0.8, 90.0))))
    converter = result.decisions[0]
    assert result.causes == ("supply_saturation",)
    assert converter.accepted.mse < 1.1
    assert converter.accepted.values()[-1] == pytest.approx(90.0, rel=0.05)


def test_the_swing_is_told_by_the_window_that_shows_it_and_from_where_the_clock_begins() -> None:
    time_s, command = commands(2500)
    shown, rows = pressure(plant("swinging"), n=2500), slice(900, 2500)
    quiet = Recording("first", time_s[:200], np.full(200, 5.0), np.zeros(200), np.full(200, 5.0))
    later = Recording("later", time_s[rows], command[rows], np.zeros(1600), shown[rows])
    starts_for = EFFECT.form("swinging").starts_for
    assert starts_for is not None
    near = [s for s in starts_for([quiet, later], Scales()) if abs(s[3] / WAVE[3] - 1.0) < 0.05]
    assert min(abs(s[1] - WAVE[1]) + abs(s[2] - WAVE[2]) for s in near) < 0.5
    assert starts_for([quiet], Scales()) == []
