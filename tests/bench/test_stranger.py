"""The stranger's plant: an honest design model, neutral at size zero, and independent of what it tests."""

from __future__ import annotations

import ast
from collections import Counter
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from bench.stranger.catalog import ALL_FORMS, EFFECT_FORMS
from bench.stranger.draw import KINDS, draw_case
from bench.stranger.excite import Session, open_loop
from bench.stranger.noise import Noise
from bench.stranger.plant import noise_free
from bench.stranger.record import noise_free_reading, run_closed, run_open, write_open
from bench.stranger.score import score
from bench.stranger.summary import calibration_error, wilson
from bench.stranger.valve import HEALTHY, TRAVEL_IN

HOUSE = Path(__file__).resolve().parents[2]
DRAW = 8  # of what comes at random times, one that comes within the short session
VOCABULARY = {
    "ep": "dead_time ep_calibration ep_deadband fill_exhaust_asymmetry ep_rate_limit supply_saturation",
    "actuator": "stiction spring_asymmetry nonlinear_spring asymmetric_damping friction_in_motion creep "
    "distributed_hysteresis position_dependent_friction friction_drift reduced_travel additional_lag flow_force",
    "sensor": "lvdt_calibration lvdt_nonlinearity lvdt_drift linkage_lost_motion sensor_lag stale_samples "
    "sensor_quantization sensor_dropouts",
}


def short_session() -> Session:
    """70 s in which every effect has something to change: steps of many sizes, reversals, both stops."""
    levels = [4.5, 10.5, 13.5, 9.0, 6.5, 4.5, 9.5, 9.6, 11.5, 10.9, 7.0, 7.2, 8.5, 11.0, 8.0, 13.5, 5.0, 9.8, 6.0, 4.5]
    return Session(np.repeat(levels, 35), 0, ())


def reference(commands_psi, row_s=0.1, substeps=400):
    """The design as the interface page prints it: Euler steps of a quarter millisecond, pressure in closed form."""
    step_s = row_s / substeps
    decay = np.exp(-step_s / 0.30)
    p, w, x, read = commands_psi[0], 0.0, 0.0, []
    for command in commands_psi:
        for _ in range(substeps):
            p = command + (p - command) * decay
            w = min(max(0.19 * (p - 8.78), min(0.19 * (p - 5.82), w), 0.0), TRAVEL_IN)
            x += step_s * min(max((w - x) / 2.7, -0.12), 0.12)
        read.append(x)
    return np.array(read)


@cache
def healthy():
    return noise_free_reading(HEALTHY, short_session(), [1])


def changed(form, size) -> float:
    """RMS [in] of what a form changes in the reading."""
    valve = form.build(HEALTHY, size, np.random.default_rng(DRAW))
    difference = noise_free_reading(valve, short_session(), [1]) - healthy()
    return float(np.sqrt(np.mean(difference**2)))


def test_the_healthy_plant_is_the_design() -> None:
    commands = short_session().commands_psi[:500]
    _, reading = noise_free(HEALTHY, commands, np.full(commands.size, 100))
    assert np.abs(reading - reference(commands)).max() < 2e-4 * TRAVEL_IN


def test_the_vocabulary_is_complete() -> None:
    assert {(form.cause, form.stage) for form in EFFECT_FORMS} == {
        (name, stage) for stage, names in VOCABULARY.items() for name in names.split()
    }


@pytest.mark.parametrize("form", ALL_FORMS, ids=lambda form: f"{form.cause}-{form.form}")
def test_a_form_changes_nothing_at_zero_and_something_at_its_largest(form) -> None:
    assert changed(form, 0.0) == 0.0
    assert changed(form, form.largest) > 0.0014


@pytest.mark.thorough
def test_a_seed_repeats(tmp_path) -> None:
    first, second = (draw_case(3, 4, "parameter", rough=True) for _ in range(2))
    assert first.label() == second.label()
    texts = []
    for case in (first, second):
        paths = write_open(run_open(case.valve, case.session, case.noise, case.seed), case.session, tmp_path)
        texts.append([path.read_text(encoding="utf-8") for path in paths])
    assert texts[0] == texts[1]
    assert texts[0][0].startswith("time_s,command_psi,pressure_psi,position_in\n")


def test_labels_have_their_shares() -> None:
    drawn = [str(np.random.default_rng([9, k]).choice(list(KINDS), p=list(KINDS.values()))) for k in range(2000)]
    counts = Counter(drawn)
    assert all(abs(counts[kind] / 2000 - share) < 0.03 for kind, share in KINDS.items())


def test_a_session_repeats_itself_and_lasts_as_long_as_a_bench_user_has() -> None:
    for seed in range(8):
        session = open_loop(np.random.default_rng(seed))
        one, two = np.split(session.commands_psi[session.skipped :], 2)
        assert np.array_equal(one, two)
        assert 300 < 0.1 * 2 * one.size < 1200


def test_the_closed_loop_comes_near_its_targets() -> None:
    rows = run_closed(HEALTHY, Noise(), np.random.default_rng(1), [1])
    assert rows.target_in is not None
    assert np.sqrt(np.mean((rows.position_in - rows.target_in) ** 2)) < 0.25 * TRAVEL_IN


def test_a_name_in_a_confusion_set_counts_apart() -> None:
    label = {"kind": "effect", "causes": [{"name": "sensor_lag", "stage": "sensor"}]}
    cause = {"name": "additional_lag", "stage": "actuator", "probability": 0.8}
    sets = [["additional_lag", "sensor_lag"]]
    marks = score(label, {"verdict": "effect", "causes": [cause], "confusable": sets})
    assert (marks["right"], marks["right_or_confusable"], marks["false"]) == (False, True, [])
    marks = score(label, {"verdict": "effect", "causes": [cause], "confusable": []})
    assert (marks["right_or_confusable"], marks["false"], marks["missed"]) == (
        False,
        ["additional_lag"],
        ["sensor_lag"],
    )


def test_rates_and_calibration() -> None:
    low, high = wilson(9, 10)
    assert (round(low, 3), round(high, 3)) == (0.596, 0.982)
    assert (
        calibration_error([{"probability": 0.9, "right": True}] * 9 + [{"probability": 0.9, "right": False}], "right")
        < 1e-9
    )


def test_the_stranger_has_read_nothing_of_ours() -> None:
    """bench/ is no package of the import contracts, so this wall stands here; only tool.py may use the command line."""
    ours = ("app", "control", "hal", "logs", "sim_device", "twin")
    for path in sorted((HOUSE / "bench" / "stranger").glob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        names = [node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
        names += [alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names]
        assert not [name for name in names if name.split(".")[0] in ours], path.name


def test_no_product_package_knows_the_bench() -> None:
    for package in ("app", "control", "hal", "logs", "sim_device", "twin"):
        for path in (HOUSE / package).rglob("*.py"):
            assert "bench.stranger" not in path.read_text(encoding="utf-8"), path.name
