"""The where-map: exact sums, the right stage, stratum and band, and nothing where there is no gap."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import maximum_filter1d

from tests.twin.toy_valve import TRAVEL, Toy, staircase
from twin.noise.model import SignalNoise
from twin.where.frequency import frequency_shares
from twin.where.map import WherePiece, where_map
from twin.where.regime import DIRECTIONS, REGIMES, classify
from twin.where.smoother import smooth_pressure
from twin.where.strata import bin_shares, class_shares
from twin.where.telescope import stage_shares, two_stage_terms

DT = 0.1
SIGMA = 8e-4
COMMAND = staircase(DT, 20.0, [5.0, 9.5, 11.0, 9.0, 7.0, 5.5, 10.5, 4.0, 13.0, 8.0] * 2)
TIME = np.arange(COMMAND.size) * DT
NOISE = SignalNoise(SIGMA, 1.0, "still", 1000, DT, (), SIGMA)


def piece(truth: Toy, seed: int = 0, p_sigma: float = 0.03) -> WherePiece:
    rng = np.random.default_rng(seed)
    true_pressure = truth.pressure(COMMAND, DT)
    reading = truth.position(true_pressure, DT) + SIGMA * rng.standard_normal(COMMAND.size)
    measured = true_pressure + p_sigma * rng.standard_normal(COMMAND.size)
    design = Toy()
    model = design.pressure(COMMAND, DT)
    smooth, _ = smooth_pressure(measured, model, p_sigma, DT)
    return WherePiece(TIME, reading, design.position(model, DT), smooth, design.position(smooth, DT))


@pytest.mark.parametrize("memory", [1.0, 3.5, 7.0])
def test_noise_is_smoothed_whatever_memory_it_was_said_to_have(memory: float) -> None:
    """A record seen through every second row once moved its play by noise, half of which was left on the pressure."""
    noise = 0.01 * np.random.default_rng(4).standard_normal(6000)
    said = ((memory - 1.0) / (memory + 1.0)) ** np.arange(200)
    left, _ = smooth_pressure(noise, np.zeros(noise.size), 0.01, DT, said)
    assert np.std(left) < 0.25 * 0.01
    step = np.where(np.arange(noise.size) < 3000, 0.0, 0.2)
    found, _ = smooth_pressure(noise + step, np.zeros(noise.size), 0.01, DT, said)
    assert np.abs(found - step)[2990:3010].max() < 0.05  # an edge is still one


def test_stage_shares_find_the_stage_and_add_to_one() -> None:
    ep = where_map([piece(Toy(ep_tau_s=2.0))], NOISE, TRAVEL)
    assert ep.stage is not None
    assert ep.stage["ep"].value == pytest.approx(1.0, abs=0.1)
    assert sum(share.value for share in ep.stage.values()) == pytest.approx(1.0, abs=1e-12)
    actuator = where_map([piece(Toy(a1=9.6))], NOISE, TRAVEL)
    assert actuator.stage is not None
    assert actuator.stage["actuator_or_sensor"].value == pytest.approx(1.0, abs=0.05)
    low, high = actuator.stage["ep"].ci95
    assert low <= actuator.stage["ep"].value <= high
    for group in (actuator.direction, actuator.regime):
        assert group is not None
        assert sum(share.value for share in group.values()) == pytest.approx(1.0)
    for bins in (actuator.position, actuator.pressure, actuator.time, actuator.frequency):
        assert bins is not None
        assert sum(b.share.value for b in bins) == pytest.approx(1.0)
        assert all(b.share.ci95[0] <= b.share.ci95[1] for b in bins)


def test_masking_stages_have_a_negative_share() -> None:
    rng = np.random.default_rng(1)
    first = rng.standard_normal(4000)
    error_terms = two_stage_terms(first + 0.1 * rng.standard_normal(4000), np.zeros(4000), 1.4 * first)
    error = error_terms["ep"] + error_terms["actuator_or_sensor"]
    shares = stage_shares(error, error_terms, 0.1, "actuator_or_sensor")
    assert shares is not None
    assert shares["actuator_or_sensor"].value == pytest.approx(-0.4, abs=0.02)
    assert shares["actuator_or_sensor"].ci95[1] < 0
    with pytest.raises(ValueError, match="do not add"):
        stage_shares(error + 1.0, error_terms, 0.1, "actuator_or_sensor")


def test_no_gap_gives_no_shares() -> None:
    where = where_map([piece(Toy())], NOISE, TRAVEL)
    assert where.stage is None
    assert where.regime is None
    assert where.frequency is None


def test_without_pressure_the_stage_is_unknown_and_false_rows_do_not_count() -> None:
    full = piece(Toy(compliance=0.23))
    reading = full.reading.copy()
    reading[::50] = 9.0
    blind = WherePiece(TIME, reading, full.full, full.pressure, None, reading < 1.0)
    where = where_map([blind, blind], NOISE, TRAVEL)
    assert where.stage is None
    assert where.position is not None
    assert where.time is not None
    assert where.time[-1].high == pytest.approx(2 * TIME[-1])
    assert all(b.share.value < 0.9 for b in where.position)


def test_a_gap_in_one_stratum_is_found_there() -> None:
    rng = np.random.default_rng(2)
    error = SIGMA * rng.standard_normal(5000)
    quantity = np.linspace(0, 1, 5000)
    error[3000:3500] += 0.01
    bins = bin_shares(error, quantity, np.linspace(0, 1, 11), SIGMA)
    assert bins is not None
    assert bins[6].share.value == pytest.approx(1.0, abs=0.03)
    classes = (quantity > 0.55).astype(np.int64) + (quantity > 0.8)
    shares = class_shares(error, classes, ("a", "b", "c"), SIGMA)
    assert shares is not None
    assert shares["b"].value == pytest.approx(1.0, abs=0.03)


def test_frequency_finds_the_band_and_takes_the_noise_off() -> None:
    rng = np.random.default_rng(3)
    time = np.arange(12000) * DT
    error = 0.01 * np.sin(2 * np.pi * 0.05 * time) + 0.01 * rng.standard_normal(time.size)
    bins = frequency_shares([(time, error)], 0.01)
    assert bins is not None
    assert next(b.share.value for b in bins if b.low == 0.03) == pytest.approx(1.0, abs=0.12)
    assert bins[0].low == 0.0
    assert bins[-1].high == pytest.approx(5.0)
    assert frequency_shares([(time[:100], error[:100])], 0.02) is None


def test_classes_follow_the_stem_not_the_noise() -> None:
    toy = Toy()
    pressure = toy.pressure(COMMAND, DT)
    clean = toy.position(pressure, DT)
    noisy = clean + 2 * SIGMA * np.random.default_rng(4).standard_normal(clean.size)
    classes = classify(TIME, noisy, clean, pressure, 2 * SIGMA, TRAVEL)
    speed = np.gradient(clean, DT)
    closing = DIRECTIONS.index("closing")
    assert np.mean(classes.direction[speed > 0.004] == closing) > 0.97
    # within a second and a half of motion either answer is right
    quiet = maximum_filter1d(np.abs(speed), 31) < 1e-5
    assert np.mean(classes.direction[quiet] == DIRECTIONS.index("still")) > 0.97
    stopped = quiet & ((clean < 1e-6) | (clean > TRAVEL - 1e-3))
    assert np.mean(classes.regime[stopped] == REGIMES.index("end_stop")) > 0.97
    inner = quiet & (clean > 0.05) & (clean < TRAVEL - 0.05)
    assert np.mean(classes.regime[inner] == REGIMES.index("deadband")) > 0.97
    assert set(np.unique(classes.regime)) == {0, 1, 2, 3}


@pytest.mark.parametrize("row_s", [1.0, 10.0])
def test_a_slow_record_moves_too(row_s: float) -> None:
    """Half a percent of travel from row to row is motion, whether rows are a second or ten apart."""
    time = np.arange(200) * row_s
    clean = TRAVEL * (0.5 + 0.3 * np.interp(np.arange(200), [0, 60, 100, 160, 199], [-1.0, 0.0, 0.0, 1.0, 1.0]))
    noisy = clean + 2e-4 * TRAVEL * np.random.default_rng(6).standard_normal(clean.size)
    classes = classify(time, noisy, clean, clean, 2e-4 * TRAVEL, TRAVEL)
    closing, still = DIRECTIONS.index("closing"), DIRECTIONS.index("still")
    assert np.all(classes.direction[5:55] == closing) and np.all(classes.direction[105:155] == closing)
    assert np.all(classes.direction[65:95] == still) and np.all(classes.direction[165:] == still)
    assert np.all(classes.regime[5:55] == REGIMES.index("moving"))


def test_smoother_removes_noise_and_keeps_edges() -> None:
    rng = np.random.default_rng(5)
    truth = Toy(ep_tau_s=0.6).pressure(COMMAND, DT)
    model = Toy(ep_tau_s=0.3).pressure(COMMAND, DT)
    measured = truth + 0.05 * rng.standard_normal(truth.size)
    measured[700:705] = np.nan
    smooth, _ = smooth_pressure(measured, model, 0.05, DT)
    calm = np.ones(truth.size, dtype=bool)
    for edge in np.flatnonzero(np.diff(COMMAND)):
        calm[edge : edge + 40] = False
    assert np.sqrt(np.mean((smooth - truth)[calm] ** 2)) < 0.05 / 3
    assert np.abs(smooth - truth).max() < 0.25  # a plain filter 1 s wide misses these steps by more than 1 psi
    same, _ = smooth_pressure(truth, model, 0.0, DT)
    assert np.allclose(same, truth)


def test_smoothed_pressure_does_not_ratchet_the_play() -> None:
    noisy = piece(Toy(), p_sigma=0.3)
    assert noisy.from_pressure is not None
    clean = Toy().position(Toy().pressure(COMMAND, DT), DT)
    raw = Toy().pressure(COMMAND, DT) + 0.3 * np.random.default_rng(9).standard_normal(COMMAND.size)
    raw_error = np.sqrt(np.mean((Toy().position(raw, DT) - clean) ** 2))
    assert np.sqrt(np.mean((noisy.from_pressure - clean) ** 2)) < 0.25 * raw_error
