"""The loop: one exchange per tick on absolute deadlines, every tick recorded. It knows the bench, never the bus."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

from control.drive import Drive, OpenLoopDrive
from control.plan import LEAD, Plan
from control.row import missing_sample, row_of
from control.settle import SettleDetector, SettleRule
from control.step import Step
from control.ticker import Ticker
from hal.bench import Bench
from hal.clock import Clock
from hal.errors import SafetyTrip, WireFault
from hal.sample import Quality, Sample

SAID_AT_MOST = 20  # of each kind of event; the rest is in the columns


class Sink(Protocol):
    """Where rows and events go: a record, a live view. Nothing here may wait."""

    def append(self, row: Mapping[str, float]) -> None: ...

    def event(self, time_s: float | None, level: str, text: str) -> None: ...

    def note(self, time_s: float | None, text: str) -> None: ...

    def state(self, time_s: float | None, text: str) -> None: ...


@dataclass(frozen=True, slots=True)
class Progress:
    """Where a run is: `done_s` of at most `total_s` [s], in step number `step` (-1: not begun to count)."""

    done_s: float
    total_s: float
    step: int
    label: str
    sample: Sample


@dataclass(frozen=True, slots=True)
class Hooks:
    """What the operator can do meanwhile: watch, write notes, and stop: `check` then raises `KeyboardInterrupt`."""

    progress: Callable[[Progress], None] = lambda _: None
    notes: Callable[[], Sequence[str]] = lambda: ()
    check: Callable[[], None] = lambda: None


@dataclass(frozen=True, slots=True)
class Outcome:
    """How a run went that came to its end."""

    rows: int
    steps_done: int
    missing: int
    overruns: int
    worst_lateness_s: float


@dataclass(slots=True)
class Loop:
    """One run on one bench. `aux` names the further channels that are recorded.

    A bench that raises `WireFault` may do so `max_missing` - 1 times in a row; one that hands out missing samples
    counts them itself (the safety layer does).

    Raises from `run`: `SafetyTrip`, whatever else the bench raises, and what `hooks.check` raises between two ticks.
    """

    bench: Bench
    clock: Clock
    sinks: Sequence[Sink] = ()
    hooks: Hooks = field(default_factory=Hooks)
    settle: SettleRule = field(default_factory=SettleRule)
    max_missing: int = 5
    aux: tuple[str, ...] = ()

    rows: int = 0
    missing: int = 0
    origin_s: float = 0.0
    _in_force: float = 0.0
    _missing_in_a_row: int = 0
    _steps_done: int = 0
    _state: str = ""
    _said: dict[str, int] = field(default_factory=dict)

    def run(self, plan: Plan, drive: Drive, in_force: float | None = None) -> Outcome:
        """Goes through the plan: its lead in open loop, its steps through `drive`.

        `in_force` is the command that the valve has before the first tick; None: the safe command.
        """
        ticker = Ticker(self.clock, plan.period_s)
        self.origin_s = ticker.origin_s
        self._in_force = self.bench.info.safe_command if in_force is None else in_force
        lead_drive = OpenLoopDrive()
        done_s = 0.0
        for number, step in enumerate((*plan.lead, *plan.steps), start=-len(plan.lead)):
            counted = number >= 0
            name = step.label or f"step {number + plan.first}"
            self.say_state("running" if counted else step.label or "conditioning")
            index = number + plan.first if counted else LEAD
            self._play(step, index, drive if counted else lead_drive, ticker, (done_s, plan.duration_s, name))
            done_s += step.duration_s
            self._steps_done += counted
        return Outcome(self.rows, self._steps_done, self.missing, ticker.overruns, ticker.worst_lateness_s)

    def now_s(self) -> float:
        """Time in the run [s], as in its record."""
        return self.clock.now_s() - self.origin_s

    def say(self, level: str, text: str) -> None:
        for sink in self.sinks:
            sink.event(self.now_s(), level, text)

    def say_state(self, text: str) -> None:
        """Tells every sink, unless they know already."""
        if text != self._state:
            self._state = text
            for sink in self.sinks:
                sink.state(self.now_s(), text)

    def _play(self, step: Step, index: int, drive: Drive, ticker: Ticker, where: tuple[float, float, str]) -> None:
        """One step, tick by tick, to its end, until the valve has settled, or until somebody wants to stop."""
        done_s, total_s, name = where
        settled = SettleDetector(self.settle)
        first, ticks = ticker.index + 1, step.ticks(ticker.period_s)
        while ticker.index + 1 - first < ticks:
            elapsed_s = (ticker.wait() - first) * ticker.period_s
            planned = step.at(elapsed_s)
            sample = self._exchange(drive.command(planned), ticker)
            self._record(sample, ticker, index, drive.target_in(planned))
            drive.saw(sample, planned)
            self.hooks.progress(Progress(done_s + elapsed_s + ticker.period_s, total_s, index, name, sample))
            for text in self.hooks.notes():
                for sink in self.sinks:
                    sink.note(self.now_s(), text)
            self.hooks.check()
            if step.until_settled and elapsed_s >= step.rise_s and self._is_settled(settled, sample):
                return

    def _exchange(self, command: float, ticker: Ticker) -> Sample:
        if ticker.skipped:
            self._say_some("overrun", f"{ticker.lateness_s * 1e3:.1f} ms late: {ticker.skipped} tick(s) left out")
        try:
            sample = self.bench.exchange(command)
        except WireFault as fault:
            sample = missing_sample(self.clock.now_s(), command, has_pressure=self.bench.info.has_pressure)
            self._say_some("missing", f"no trusted reply: {fault}")
            self._count_missing(fault)
            return sample
        if sample.foreign_psi is not None:
            held = f"the device held {sample.foreign_psi:.4g} {self.bench.info.command_unit}, not what it was sent"
            self._say_some("foreign command", f"{held}: does somebody else command it?")
        if sample.position.quality & Quality.MISSING:
            self._say_some("missing", "no trusted reply in this tick")
            self.missing += 1
        else:
            self._missing_in_a_row = 0
        return sample

    def _count_missing(self, fault: WireFault) -> None:
        self.missing += 1
        self._missing_in_a_row += 1
        if self._missing_in_a_row >= self.max_missing:
            raise SafetyTrip(
                f"no trusted reply in {self._missing_in_a_row} ticks one after the other: {fault}"
            ) from fault

    def _record(self, sample: Sample, ticker: Ticker, index: int, target_in: float) -> None:
        row = row_of(
            sample,
            unit=self.bench.info.command_unit,
            origin_s=self.origin_s,
            in_force=self._in_force,
            lateness_s=ticker.lateness_s,
            step=index,
            target_in=target_in,
            aux=self.aux,
        )
        for sink in self.sinks:
            sink.append(row)
        self._in_force = sample.commanded_psi
        self.rows += 1

    def _is_settled(self, detector: SettleDetector, sample: Sample) -> bool:
        pressure = None if sample.pressure is None else sample.pressure.value
        return detector.update(sample.time_s, sample.position.value, pressure)

    def _say_some(self, kind: str, text: str) -> None:
        count = self._said.get(kind, 0) + 1
        self._said[kind] = count
        if count <= SAID_AT_MOST:
            more = "; further ones are only counted" if count == SAID_AT_MOST else ""
            self.say("warning", f"{kind}: {text}{more}")
