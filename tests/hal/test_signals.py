from __future__ import annotations

import os
import signal

import pytest

from hal.signals import Stopped, shielded, stop_signals


def send(name: str) -> None:
    os.kill(os.getpid(), getattr(signal, name))


def test_the_first_ctrl_c_lets_the_tick_finish() -> None:
    with stop_signals() as stop:
        stop.check()
        send("SIGINT")
        finished = True
        with pytest.raises(Stopped, match="SIGINT"):
            stop.check()
    assert finished


def test_the_second_ctrl_c_does_not_wait() -> None:
    with stop_signals():
        send("SIGINT")
        with pytest.raises(Stopped, match="SIGINT"):
            send("SIGINT")


@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP"])
def test_an_order_to_terminate_runs_every_finally(name) -> None:
    passed = []
    with pytest.raises(Stopped) as caught, stop_signals():
        try:
            send(name)
        finally:
            passed.append(name)
    assert passed == [name]
    assert caught.value.signal_name == name
    assert isinstance(caught.value, KeyboardInterrupt)


def test_handlers_are_put_back() -> None:
    before = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)]
    with stop_signals(), shielded():
        assert signal.getsignal(signal.SIGINT) is not before[0]
    assert [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)] == before


def test_signals_wait_behind_the_shield() -> None:
    passed = []
    with pytest.raises(Stopped, match="SIGTERM"), shielded():
        send("SIGTERM")
        passed.append("safe")
    assert passed == ["safe"]


def test_an_error_behind_the_shield_is_not_replaced_by_a_signal() -> None:
    with pytest.raises(ValueError, match="mine"), shielded():
        send("SIGTERM")
        raise ValueError("mine")
