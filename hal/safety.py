"""Safety is a layer around any bench, not a habit of whoever uses it: limits, lost readings, and every way out."""

from __future__ import annotations

import contextlib
import math
from dataclasses import dataclass
from types import TracebackType
from typing import Literal, Self

from hal.bench import Bench, BenchInfo
from hal.clock import Clock
from hal.deadman import Deadman
from hal.errors import BenchFault, SafetyTrip
from hal.latch import Latch
from hal.profile import Limits
from hal.sample import Quality, Sample
from hal.signals import Stopped, shielded
from hal.whereabouts import whereabouts

UNTRUSTED = Quality.MISSING | Quality.SENTINEL | Quality.IMPLAUSIBLE
_CONFIRM = 2  # readings in a row beyond a limit that are no longer taken for a spike
_HELD = 1e-6  # from which difference on a command counts as held
_FIRST_DT_S = 0.01  # the first command has no interval before it; its slew is measured over this one


@dataclass(frozen=True, slots=True)
class WayOut:
    """How a bench was left, for the record. `safe`: the device confirmed its safe command."""

    status: Literal["success", "abort", "fail"]
    reason: str
    safe: bool


class SafeBench:
    """Any bench, held to its limits. Commands are clamped to range and slew; `commanded_psi` tells what was sent.

    `latch`: the emergency stop that must be acknowledged first. `deadman_s`: when an `exchange` is overdue by so
    much in real time, a thread of its own sends the valve to safety; None: only the device's watchdog does.
    Both watch from `arm` on, or from the first `exchange`, until the valve has been made safe.
    Raises from `exchange`: `SafetyTrip`, after sending the valve to safety; what the bench raises.
    """

    def __init__(
        self, bench: Bench, limits: Limits, clock: Clock, *, latch: Latch | None = None, deadman_s: float | None = None
    ) -> None:
        self.way_out: WayOut | None = None  # known once the bench has been left
        self.clamped = 0  # commands that were not sent as they were given
        self.safe: bool | None = None  # whether the last `make_safe` was confirmed; None before the first
        self.sent: float | None = None  # the last command of an `exchange`, whether or not it arrived
        self._bench = bench
        self._limits = limits
        self._clock = clock
        self._latch = latch
        self._deadman_s = deadman_s
        self._deadman: Deadman | None = None
        self._trip: str | None = None
        self._command = 0.0
        self._command_s: float | None = None
        self._good_s = 0.0
        self._missing = 0
        self._beyond = 0

    @property
    def info(self) -> BenchInfo:
        return self._bench.info

    @property
    def bench(self) -> Bench:
        """What is inside, for counters and the like; commands go through `exchange`."""
        return self._bench

    @property
    def where(self) -> str:
        """Where the valve is, once it was sent to safety, for the operator."""
        return whereabouts(self.info, bool(self.safe) if self.way_out is None else self.way_out.safe, self.sent)

    def __enter__(self) -> Self:
        if self._latch is not None:
            self._latch.check()
        self._bench.__enter__()
        try:
            held = getattr(self._bench, "held_command", None)
            self._command = self._bench.info.safe_command if held is None or not math.isfinite(held) else held
            self._good_s = self._clock.now_s()
        except BaseException as error:  # entered or not: nobody else would leave it
            self._bench.__exit__(type(error), error, error.__traceback__)
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._rest()
        with shielded():
            status, reason = describe_way_out(error)
            safe = self._bench.make_safe(reason)
            self.way_out = WayOut(status, reason, safe)
            try:
                self._bench.__exit__(kind, error, trace)
            finally:
                if not safe:
                    self._shout(reason, error)

    def arm(self, period_s: float = 0.0) -> None:
        """Commands will come every `period_s` from now on: the device and the dead man's thread may expect them.

        The last reading is fresh from now on: whatever took time since the bench was opened was not its fault.
        Raises: what the bench raises.
        """
        arm = getattr(self._bench, "arm", None)
        if arm is not None:
            arm()
        self._good_s = self._clock.now_s()
        if self._deadman_s is not None and self._deadman is None:
            self._deadman = Deadman(self._deadman_s + period_s, self._stalled)
            self._deadman.start()

    def _rest(self) -> None:
        """Nobody expects commands any more."""
        deadman, self._deadman = self._deadman, None
        if deadman is not None:
            deadman.stop()

    def exchange(self, command_psi: float) -> Sample:
        """Sends what the limits leave of the command and judges what comes back."""
        if self._trip is not None:
            raise SafetyTrip(self._trip)
        if self._latch is not None and self._latch.is_set():  # `lostmotion vent --emergency` elsewhere
            self._trip_now(f"emergency stop ({self._latch.engaged()})")
        if not math.isfinite(command_psi):
            self._trip_now(f"command {command_psi} is not a number; whatever made it is at fault")
        allowed, now_s = self._allowed(command_psi), self._clock.now_s()
        if self._deadman is not None:
            self._deadman.feed()
        elif self._deadman_s is not None:
            self.arm()
        self.sent = allowed
        sample = self._bench.exchange(allowed)
        if self._trip is not None:  # the dead man's thread acted while we waited
            raise SafetyTrip(self._trip)
        self.clamped += abs(allowed - command_psi) > _HELD
        self._command, self._command_s = allowed, now_s
        self._judge(sample)
        return sample

    def make_safe(self, reason: str) -> bool:
        """As the bench does; once it is safe, nobody waits for commands before the next one comes.

        That is a first one again: its slew counts from where the bench is then, and not over the time it stood there.
        """
        self._rest()
        if self.info.profile.get("safe_direction") != "hold":
            self._command = self.info.safe_command
        self._command_s = None
        safe = self.safe = self._bench.make_safe(reason)
        disarm = getattr(self._bench, "disarm", None)
        if safe and disarm is not None:
            disarm()
        return safe

    def emergency_stop(self, reason: str) -> bool:
        """Safe now, and nothing moves again before somebody acknowledges it. True when the device confirmed."""
        self._trip = f"emergency stop: {reason}"
        stop = getattr(self._bench, "emergency_stop", None)
        safe = bool(stop()) if stop is not None else self._bench.make_safe(self._trip)
        self._engage(self._trip)
        return safe

    def _engage(self, reason: str) -> None:
        if self._latch is not None:
            with contextlib.suppress(OSError):  # a full disk must not come between us and the valve
                self._latch.engage(reason)

    def _allowed(self, command: float) -> float:
        """What range and slew leave of a command. A bench that was left out of range comes into it at once: the range
        is what the bench bears, the slew what is kind to it."""
        limits = self._limits
        command = min(max(command, limits.command_min), limits.command_max)
        if limits.slew_per_s is None:
            return command
        dt_s = _FIRST_DT_S if self._command_s is None else self._clock.now_s() - self._command_s
        step = limits.slew_per_s * dt_s
        before = min(max(self._command, limits.command_min), limits.command_max)
        return min(max(command, before - step), before + step)

    def _judge(self, sample: Sample) -> None:
        quality = sample.position.quality | (sample.pressure.quality if sample.pressure else Quality.GOOD)
        now_s = self._clock.now_s()
        self._missing = self._missing + 1 if quality & UNTRUSTED else 0
        if not quality & (UNTRUSTED | Quality.STALE):
            self._good_s = now_s
        if self._missing > self._limits.max_missing:
            self._trip_now(f"no trusted reading in {self._missing} ticks in a row (limit {self._limits.max_missing})")
        age_s = now_s - self._good_s
        if age_s > self._limits.max_age_s:
            self._trip_now(f"the last fresh reading is {age_s:.3g} s old (limit {self._limits.max_age_s:g} s)")
        beyond = None if quality & UNTRUSTED else self._beyond_limit(sample)
        self._beyond = self._beyond + 1 if beyond else 0
        if beyond and self._beyond >= _CONFIRM:
            self._trip_now(beyond)

    def _beyond_limit(self, sample: Sample) -> str | None:
        limits, position = self._limits, sample.position.value
        low, high, most = limits.position_min_in, limits.position_max_in, limits.pressure_max_psi
        if low is not None and position < low:
            return f"position {position:.4f} in is below its limit of {low:g} in; check the LVDT and its calibration"
        if high is not None and position > high:
            return f"position {position:.4f} in is above its limit of {high:g} in; check the LVDT and its calibration"
        if most is not None and sample.pressure is not None and sample.pressure.value > most:
            return f"pressure {sample.pressure.value:.3f} psi is above its limit of {most:g} psi; check the supply"
        return None

    def _trip_now(self, reason: str) -> None:
        self._trip = reason
        safe = self._bench.make_safe(reason)
        raise SafetyTrip(f"{reason}; {whereabouts(self.info, safe, self.sent)}")

    def _stalled(self) -> None:
        self._trip = "the loop stalled and the dead man's thread sent the valve to safety"
        self._bench.make_safe(self._trip)

    def _shout(self, reason: str, error: BaseException | None) -> None:
        where = whereabouts(self.info, False, self.sent)
        said = reason if where in reason else f"{where}, after: {reason}"
        text = f"{said}. Shut off its supply and look at it"
        self._engage(text)
        raise BenchFault(text) from error


def describe_way_out(error: BaseException | None) -> tuple[Literal["success", "abort", "fail"], str]:
    """The run status and one clause for an exception that ends a run; None is the normal end."""
    if error is None:
        return "success", "normal end"
    if isinstance(error, Stopped):
        return "abort", {"SIGINT": "Ctrl-C", "SIGHUP": "terminal closed (SIGHUP)"}.get(
            error.signal_name, f"terminated ({error.signal_name})"
        )
    if isinstance(error, KeyboardInterrupt):
        return "abort", "Ctrl-C"
    if isinstance(error, SafetyTrip):
        return "fail", f"safety trip: {error}"
    return "fail", f"{type(error).__name__}: {error}"
