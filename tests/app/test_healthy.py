"""`lostmotion diagnose --healthy`: what the design misses on the machine when nothing is wrong is no gap."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from control.design import DesignModel, save_design
from hal.errors import BadInput
from logs.recording import Recording
from tests.app.test_diagnose import columns_of, diagnosed, no_pictures, said, write
from tests.twin.judged import a_record
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant
from twin.ready.healthy import healthy_margin

__all__ = ["no_pictures"]  # a fixture of these tests too

CREEP = Inserted("creep", effect("creep").form("one_tail"), (0.012, 30.0))
LAG = Inserted("sensor_lag", effect("sensor_lag").form("first_order"), (0.5,))


@pytest.fixture(scope="module")
def golden() -> Recording:
    """A machine that creeps a little, and always did."""
    return a_record(Plant(DesignModel(), (CREEP,)), seed=3)


@pytest.mark.thorough
def test_a_machine_that_is_as_it_always_was_has_no_gap(golden: Recording, tmp_path: Path) -> None:
    healthy = write(tmp_path / "healthy.csv", columns_of(golden))
    today = write(tmp_path / "today.csv", columns_of(a_record(Plant(DesignModel(), (CREEP,)))))
    design = ("--design", str(tmp_path / "design.toml"))
    save_design(DesignModel(), tmp_path / "design.toml", "the design")
    assert diagnosed(tmp_path / "without", today, *design)["verdict"] == "effect"
    document = diagnosed(tmp_path / "with", today, *design, "--healthy", healthy)
    assert document["verdict"] == "no_gap"
    assert "the design misses the healthy machine by" in said(document)


@pytest.mark.thorough
def test_what_has_changed_since_is_named_alone(golden: Recording, tmp_path: Path) -> None:
    """Without a design the healthy recordings give one."""
    healthy = write(tmp_path / "healthy.csv", columns_of(golden))
    today = write(tmp_path / "today.csv", columns_of(a_record(Plant(DesignModel(), (CREEP, LAG)))))
    document = diagnosed(tmp_path / "out", today, "--healthy", healthy)
    assert [c["name"] for c in document["causes"]] in (["sensor_lag"], ["additional_lag"])
    assert "identified from the healthy recordings" in said(document)


def test_the_margin_is_what_is_missed_beyond_the_noise(golden: Recording) -> None:
    assert golden.pressure is not None
    exact = healthy_margin([golden], Plant(DesignModel(), (CREEP,)))
    assert exact.position < 2e-4 and exact.pressure < 2e-3
    off = replace(golden, position=golden.position + 0.004 * np.sign(np.sin(0.1 * golden.time_s)), pressure=None)
    assert healthy_margin([off], Plant(DesignModel(), (CREEP,))).position == pytest.approx(0.004, rel=0.1)
    assert healthy_margin([off], Plant(DesignModel(), (CREEP,))).pressure == 0.0


def test_another_machine_is_refused(golden: Recording) -> None:
    with pytest.raises(BadInput, match=r"misses this healthy recording by .* give the design that belongs"):
        healthy_margin([golden], Plant(DesignModel(a1=14.0, a2=11.0)))
