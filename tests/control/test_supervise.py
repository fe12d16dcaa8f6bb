"""Every way out makes the valve safe first and then closes the record with the way it was."""

from __future__ import annotations

import pytest

from control.loop import Loop, Outcome
from control.supervise import supervised
from hal.clock import SteppedClock
from hal.errors import PortFault, SafetyTrip
from hal.signals import Stopped
from tests.control.fakes import Memory, ToyBench

DONE = Outcome(1, 1, 0, 0, 0.0)


def leave(error: BaseException | None, *, confirmed: bool = True) -> tuple[ToyBench, Memory]:
    clock, memory = SteppedClock(), Memory()
    bench = ToyBench(clock, safe_confirmed=confirmed)

    def job() -> Outcome:
        if error is not None:
            raise error
        return DONE

    loop = Loop(bench, clock, (memory,))
    if error is None:
        assert supervised(loop, memory, job) is DONE
    else:
        with pytest.raises(type(error)):
            supervised(loop, memory, job)
    return bench, memory


@pytest.mark.parametrize(
    ("error", "status", "words"),
    [
        (None, "success", "normal end"),
        (KeyboardInterrupt(), "abort", "Ctrl-C"),
        (Stopped("SIGTERM"), "abort", "SIGTERM"),
        (Stopped("SIGHUP"), "abort", "terminal closed"),
        (SafetyTrip("too high"), "fail", "safety trip: too high"),
        (PortFault("unplugged"), "fail", "PortFault: unplugged"),
        (ZeroDivisionError("oops"), "fail", "ZeroDivisionError: oops"),
    ],
)
def test_each_way_out_is_recorded_after_the_valve_is_safe(error: BaseException | None, status: str, words: str) -> None:
    bench, memory = leave(error)
    assert len(bench.made_safe) == 1
    assert [closed[0] for closed in memory.closed] == [status]
    assert words in memory.closed[0][1]
    assert "confirmed its safe state" in memory.closed[0][1]
    assert memory.states[-1][1] == "safe"


def test_an_unconfirmed_safe_command_is_said_loudly() -> None:
    _, memory = leave(None, confirmed=False)
    assert "NOT confirmed" in memory.closed[0][1]
    assert memory.events[-1][1] == "error"
    assert memory.states[-1][1] == "fault"
