"""Numbers beside a number that is far off, by which little of the gap is left and many times the noise."""

from __future__ import annotations

from dataclasses import replace

import pytest

from control.design import DesignModel
from tests.twin.judged import a_record, judged
from twin.choose.plainer import plainer
from twin.choose.rules import DecisionRules
from twin.model.plant import Plant


@pytest.mark.thorough
def test_a_second_number_beside_one_that_is_far_off_is_named() -> None:
    """The lag is off by 7 %, which is 2 in 1000 of the gap that the offset makes, and many times the noise."""
    off = DesignModel(a1=DesignModel().a1 - 0.7, a2=DesignModel().a2 - 0.7, tau_s=0.93 * DesignModel().tau_s)
    result, _ = judged(a_record(Plant(off)))
    assert result.decisions[-1].names == ("parameter:offset", "parameter:tau")
    findings = result.decisions[-1].findings
    one = next(f for f in findings.fits if f.names == ("parameter:offset",))
    assert one.mse - 1.0 < 0.005 * findings.none.mse
    # numbers alone are no cause that spares numbers, wherever re-tuning all of them has ended
    astray = replace(findings, retuned=replace(findings.retuned, mse=1e6))
    both = next(f for f in findings.fits if f.names == ("parameter:offset", "parameter:tau"))
    assert plainer(astray, both, DecisionRules()).names == both.names
