"""Opening a bench without a port: a virtual valve behind real frames, safe again on every way out."""

from __future__ import annotations

import threading

import pytest

from app.session import open_bench
from hal.clock import RealClock, SteppedClock
from hal.errors import BadInput, PortFault, SafetyTrip
from hal.profile import Profile, load_profile
from sim_device.physics.catalog import make_physics
from sim_device.server import VirtualDevice


def test_the_virtual_valve_answers_over_a_pseudo_terminal_in_stepped_time() -> None:
    with open_bench(seed=4, options={"noise": 0.0}) as session:
        assert isinstance(session.clock, SteppedClock)
        assert session.bench.info.port.startswith("/dev/")
        assert "virtual valve ('thesis')" in session.title
        assert session.aux_units["supply_psi"] == "psi"
        session.bench.exchange(12.0)
        start_s = session.clock.now_s()
        for tick in range(200):
            session.clock.sleep_until(start_s + 0.1 * (tick + 1))
            sample = session.bench.exchange(12.0)
        assert sample.position.value == pytest.approx(0.5625, abs=0.002)
        assert sample.pressure is not None
        assert sample.pressure.value == pytest.approx(12.0, abs=0.01)
    assert session.bench.way_out is not None
    assert session.bench.way_out.safe


def test_an_error_inside_leaves_the_valve_safe() -> None:
    with pytest.raises(ZeroDivisionError), open_bench() as session:
        session.bench.exchange(10.0)
        raise ZeroDivisionError
    assert session.bench.way_out is not None
    assert (session.bench.way_out.status, session.bench.way_out.safe) == ("fail", True)


def test_effects_and_numbers_reach_the_plant() -> None:
    with open_bench(effects=("stiction=0.4",), options={"a1": 9.0}) as session:
        assert session.virtual["options"] == {"a1": 9.0, "effects": {"stiction": 0.4}}
    with open_bench(effects=("stiction=0.4",), plant=("compliance=0.18", "noise=0")) as session:
        assert session.virtual["options"] == {"compliance": 0.18, "noise": 0.0, "effects": {"stiction": 0.4}}
    for wrong in ({"effects": ("stiction=big",)}, {"plant": ("a1",)}, {"plant": ("noise=nan",)}):
        with pytest.raises(BadInput, match="NAME=SIZE"), open_bench(**wrong):
            pass
    with pytest.raises(BadInput, match="there is --effect"), open_bench(plant=("effects=1",)):
        pass
    for unknown in ("a9=1", "seed=3"):
        with pytest.raises(BadInput, match="its numbers are"), open_bench(plant=(unknown,)):
            pass
    with pytest.raises(BadInput, match="leave them out with --port"), open_bench("/dev/absent", plant=("a1=9",)):
        pass


def test_a_profile_may_be_given_as_it_is_and_its_unit_chooses_the_plant() -> None:
    with open_bench(profile=load_profile("virtual")) as session:
        assert session.virtual["physics"] == "thesis"
        assert session.command_in_force == 0.0


def test_a_port_that_is_not_there() -> None:
    with pytest.raises(PortFault, match="/dev/absent"), open_bench("/dev/absent"):
        pass


def test_on_a_real_port_a_dead_mans_thread_watches_the_loop(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.session.DEADMAN_S", 0.05)
    content = load_profile("virtual").model_dump(mode="json", exclude_none=True)
    content["devices"]["bench"].pop("watchdog")  # nobody else would notice
    profile = Profile.model_validate(content)
    acted = threading.Event()
    with VirtualDevice(profile, make_physics("thesis", 1), RealClock()) as device:
        with pytest.raises(SafetyTrip, match="the loop stalled"), open_bench(device.port, profile) as session:
            make_safe = session.bench.bench.make_safe
            monkeypatch.setattr(session.bench.bench, "make_safe", lambda why: (make_safe(why), acted.set())[0])
            assert session.bench.exchange(12.0).readback_psi == 12.0
            assert acted.wait(10.0)
            assert device.rig.command == 0.0
            session.bench.exchange(12.0)
        assert device.rig.command == 0.0
