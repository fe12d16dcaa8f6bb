from __future__ import annotations

import math

import numpy as np
import pytest

from hal.errors import BadInput
from sim_device.physics.catalog import imperfections, make_physics, names, parameters
from sim_device.physics.offline import record
from tests.sim_device.physics.excitation import lively

# The shared vocabulary of causes, in the order of its table.
EFFECTS = {
    *("dead_time", "ep_calibration", "ep_deadband", "fill_exhaust_asymmetry", "ep_rate_limit", "supply_saturation"),
    *("stiction", "spring_asymmetry", "nonlinear_spring", "asymmetric_damping", "friction_in_motion", "creep"),
    *("distributed_hysteresis", "position_dependent_friction", "friction_drift", "reduced_travel", "additional_lag"),
    *("flow_force", "lvdt_calibration", "lvdt_nonlinearity", "lvdt_drift", "linkage_lost_motion", "sensor_lag"),
    *("stale_samples", "sensor_quantization", "sensor_dropouts"),
}
NUMBERS = ["deadband", "offset", "compliance", "tau", "rate_limit", "ep_tau"]


def test_the_plants_are_found_as_files() -> None:
    assert names() == ["chapter3", "positioner", "reference", "thesis"]


@pytest.mark.parametrize("plant", ["thesis", "reference"])
def test_both_families_know_every_effect_every_design_number_and_six_outsiders(plant: str) -> None:
    known = imperfections(plant)
    baseline = {"friction_in_motion"} if plant == "reference" else set()  # it is how that plant is built
    assert {item.name for item in known if not item.outsider} == EFFECTS - baseline
    assert sum(item.outsider for item in known) >= 6
    assert [item.name for item in parameters(plant)] == [f"parameter:{name}" for name in NUMBERS]


@pytest.mark.parametrize("plant", names())
def test_every_imperfection_is_described_and_has_three_growing_sizes_within_its_limit(plant: str) -> None:
    for item in (*imperfections(plant), *parameters(plant)):
        assert item.stage in ("ep", "actuator", "sensor")
        assert item.claim.endswith(".") and item.unit
        assert 0.0 < item.sizes[0] < item.sizes[1] < item.sizes[2]
        assert len(item.scales) in (0, len(item.forms))
        assert all(item.size(2, form) <= item.limit for form in item.forms)


@pytest.mark.parametrize("plant", names())
def test_the_same_seed_replays_bit_for_bit_and_another_differs_only_by_noise(plant: str) -> None:
    time_s, command = lively(40)
    first, again, other = (record(make_physics(plant, seed), time_s, command) for seed in (3, 3, 4))
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)
    assert np.max(np.abs(first[1] - other[1])) < 0.02


@pytest.mark.parametrize("plant", names())
def test_the_first_call_sets_the_origin_and_time_never_runs_back(plant: str) -> None:
    valve = make_physics(plant, noise=0.0)
    assert valve.advance(1.0e6, 9.0).pressure_psi == 0.0
    later = valve.advance(1.0e6 + 60.0, 60.0 if plant == "positioner" else 11.0)
    assert later.position_in > 0.2
    assert valve.advance(1.0e6 + 20.0, 4.0).position_in == pytest.approx(later.position_in, abs=1e-9)


def test_the_bench_of_chapter_3_is_the_thesis_valve_with_a_converter_that_does_not_let_all_air_out() -> None:
    time_s = 0.1 * np.arange(1200.0)
    command = np.where(time_s < 60.0, 11.0, 9.0)
    pressure, _ = record(make_physics("chapter3", noise=0.0), time_s, command)
    assert pressure[500] == pytest.approx(11.0, abs=1e-3)
    assert pressure[-1] == pytest.approx(9.07, abs=1e-3)
    options = {"effects": {"ep_deadband": 0.0, "ep_calibration/zero": 0.0}, "compliance": 0.19}
    plain = [
        record(make_physics("thesis", 5), time_s, command),
        record(make_physics("chapter3", 5, **options), time_s, command),
    ]
    assert np.array_equal(*plain)


@pytest.mark.parametrize("plant", ["thesis", "reference"])
def test_what_the_valve_does_hardly_depends_on_how_often_it_is_asked(plant: str) -> None:
    def position(step_s: float) -> float:
        valve = make_physics(plant, noise=0.0)
        valve.advance(0.0, 11.0)
        for k in range(1, round(6.0 / step_s) + 1):
            seen = valve.advance(k * step_s, 11.0)
        return seen.position_in

    assert position(3.0) == pytest.approx(position(0.0313 * 0.5), abs=0.0015 * 0.5625)


@pytest.mark.parametrize(
    ("plant", "options", "words"),
    [
        ("piano", {}, "there is no physics 'piano'; choose one of chapter3, positioner, reference, thesis"),
        ("thesis", {"effects": {"rust": 1.0}}, "effect 'rust' is not known"),
        ("thesis", {"effects": {"creep/sideways": 0.1}}, "no form 'sideways'; it has two, one, log"),
        ("thesis", {"effects": {"creep": 7.0}}, "size 7.0 1 is outside 0 to 0.6 1"),
        ("thesis", {"effects": {"creep": -0.1}}, "outside 0 to 0.6"),
        ("reference", {"effects": {"stiction": math.nan}}, "size nan psi"),
        ("thesis", {"effects": {"parameter:colour": 1.0}}, "the design numbers are parameter:deadband"),
        ("thesis", {"effects": {"parameter:tau": -2.0}}, "makes no valve"),
        ("thesis", {"tau": 0.0}, "'tau' is 0.0; it must be above 0"),
        ("thesis", {"a1": 5.0}, "a1 must not be below a2"),
        ("thesis", {"mass": 5.0}, "option 'mass' is not known"),
        ("reference", {"a1": 5.0}, "option 'a1' is not known"),
        ("reference", {"mass": -5.0}, "'mass' is -5.0; it must be 0 or above"),
        (
            "positioner",
            {"colour": 1.0},
            "its numbers are ep_tau, a1, a2, compliance, tau, rate_limit, travel, lever_rad",
        ),
        ("reference", {"seed": 3.0}, "option 'seed' is not known"),
        ("chapter3", {"name": 3.0}, "option 'name' is not known"),
    ],
)
def test_what_cannot_be_made_is_refused_in_one_sentence(plant: str, options: dict[str, object], words: str) -> None:
    with pytest.raises(BadInput) as refusal:
        make_physics(plant, **options)
    assert words in str(refusal.value)
