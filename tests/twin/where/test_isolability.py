"""Structural isolability of the chain, against the table made with an independent toolbox."""

from __future__ import annotations

import pytest

from twin.where.isolability import describe, isolable_groups


@pytest.mark.parametrize(
    ("signals", "groups"),
    [
        ("", ["actuator ep link sensor"]),
        ("pressure", ["ep link", "actuator sensor", "pressure_sensor"]),
        ("pressure command_readback", ["link", "ep", "actuator sensor", "pressure_sensor"]),
        ("pressure command_readback second_position", ["link", "ep", "actuator", "sensor", "pressure_sensor"]),
    ],
)
def test_groups(signals: str, groups: list[str]) -> None:
    found = isolable_groups(frozenset(signals.split()))
    assert [" ".join(sorted(group)) for group in found] == groups


def test_sentences_name_the_signal_that_would_help() -> None:
    lines = describe(frozenset({"pressure"}))
    assert "actuator | position sensor" in lines[0]
    assert any("second position" in line and "actuator | position sensor" in line for line in lines[1:])
    everything = describe(frozenset({"pressure", "command_readback", "second_position"}))
    assert everything == ["The signals can tell every stage from every other."]
    with pytest.raises(KeyError):
        isolable_groups(frozenset({"temperature"}))
