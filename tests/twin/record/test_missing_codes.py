"""A converter that lacks codes: what the readings show of it, and that nothing else is named for it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from control.design import DesignModel
from logs.recording import FloatArray
from tests.twin.judged import UP_TO_TWO, a_record
from twin.diagnose import diagnose
from twin.events.scan import scan_events
from twin.model.plant import Plant
from twin.noise.lattice import missing_codes, rounding_bias, rounding_error
from twin.noise.model import estimate_noise
from twin.ready.rounding import rounding_down
from twin.record.sensing import sense

STEP = 0.004


def read(true: FloatArray, every: int, up: bool = False) -> FloatArray:
    """Rounded to the nearest code; each `every`-th one does not exist and is read as the one below, or above."""
    codes = np.round(true / STEP)
    return STEP * np.where(codes % every == 1, codes + (1.0 if up else -1.0), codes)


@given(st.integers(3, 9), st.booleans())
def test_error_and_bias_are_those_of_the_converter(every: int, up: bool) -> None:
    true = np.random.default_rng(every).uniform(0.0, 90 * every * STEP, 400_000)
    seen = read(true, every, up)
    error = (seen - true) / STEP
    assert missing_codes(seen, STEP)[0] == pytest.approx(90, abs=1)
    assert rounding_error(seen, STEP) == pytest.approx(float(np.mean(error**2)), rel=0.03)
    assert rounding_bias(seen, STEP) == pytest.approx(abs(float(np.mean(error))), rel=0.03)


def test_a_code_that_chance_left_out_is_not_missing() -> None:
    rare = np.random.default_rng(1).uniform(0.0, 300 * STEP, 900)  # three readings a code
    seen = STEP * np.round(rare / STEP)
    assert np.unique(seen).size < 300
    assert missing_codes(seen, STEP)[0] == 0
    assert rounding_error(seen, STEP) == pytest.approx(1.0 / 12.0) and rounding_bias(seen, STEP) == 0.0


@pytest.mark.thorough
@pytest.mark.parametrize("every", [3, 5])
def test_nothing_else_is_named_for_missing_codes(every: int) -> None:
    made = a_record(Plant(DesignModel()), n=2400)
    record = replace(made, position=read(made.position, every))
    assert not scan_events(record, estimate_noise([record])).false_position.any()
    diagnosis = diagnose([record], DesignModel(), (), UP_TO_TWO).diagnosis
    assert [c.name for c in diagnosis.causes] == ["sensor_quantization"]
    assert any("codes of the position never occur" in note.what for note in diagnosis.data_quality)


@pytest.mark.parametrize("up", [False, True])
def test_the_error_of_the_zero_that_missing_codes_make_is_no_calibration(up: bool) -> None:
    made = a_record(Plant(DesignModel()), n=2400)
    record = replace(made, position=read(made.position, 3, up))
    sensing = sense([record], estimate_noise([record]), DesignModel())
    (found,) = rounding_down([record], Plant(DesignModel()), sensing)
    assert found.values == pytest.approx(((1.0 if up else -1.0) * STEP / 3.0,), rel=0.2)  # codes at the ends are unsure
