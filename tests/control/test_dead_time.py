"""The dead time is found from the pressure."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from control.dead_time import LONGEST_TICKS, no_dead_time

SHARE = 1.0 - math.exp(-0.1 / 0.3)


@pytest.mark.parametrize("true_ticks", [0, 1, 2, 5])
def test_whole_ticks_are_found_from_a_few_steps(true_ticks: int) -> None:
    line, pressure, sent = no_dead_time(8.0), 8.0, [8.0] * (LONGEST_TICKS + 2)
    for tick in range(80):
        command = 8.0 + 2.0 * ((tick // 15) % 2)
        before = pressure
        pressure += SHARE * (sent[true_ticks] - pressure)
        line = line.judged(pressure, lambda u, p=before: p + SHARE * (u - p)).and_sent(command)
        sent = [command, *sent[:-1]]
    assert line.ticks == true_ticks
    assert line.arriving == sent[true_ticks]
    assert line.next_tick == ((sent[true_ticks], 1.0),)
    assert line.after_that == tuple((command, 1.0) for command in reversed(sent[:true_ticks]))


def test_parts_of_a_tick_are_found_too() -> None:
    """The lag in closed form, with every command coming into force half a tick after the first whole one."""
    line, pressure, sent, keep = no_dead_time(8.0), 8.0, [8.0] * (LONGEST_TICKS + 2), 1.0 - SHARE
    line = replace(line, pace=0.1 / 0.3)
    for tick in range(80):
        command = 8.0 + 2.0 * ((tick // 15) % 2)
        before = pressure
        pressure = sent[2] + (pressure - sent[2]) * keep**0.5
        pressure = sent[1] + (pressure - sent[1]) * keep**0.5
        line = line.judged(pressure, lambda u, p=before: p + SHARE * (u - p)).and_sent(command)
        sent = [command, *sent[:-1]]
    assert line.ticks == 1.5
    assert line.next_tick == ((sent[2], 0.5), (sent[1], 0.5))
    assert line.after_that == ((sent[1], 0.5), (sent[0], 1.0))


def test_noise_alone_finds_none() -> None:
    line = no_dead_time(8.0)
    for tick in range(300):
        line = line.judged(8.0 + 0.01 * math.sin(7.0 * tick), lambda u: u).and_sent(8.0)
    assert line.ticks == 0
