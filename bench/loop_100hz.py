"""100 ticks a second at 115200 baud with function 23, with record and live view on and off:
`python bench/loop_100hz.py [--seconds S] [--rounds N]`.

The device is a process of its own behind a line paced at 115200 baud. Rounds with nothing, the record alone, the view
alone and both take turns. A tick overruns when the next deadline has passed before it is done. On a machine with other
jobs the quietest round of each kind says more than all of them together; both are printed. The last column: for how
long the host of a virtual machine gave its processors to others meanwhile (0 where the system does not say).
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path

PERIOD_S = 0.01
MODES = ("off", "record", "view", "both")


class Columns:
    """A sink that keeps what it needs in memory: what a run without record and view costs."""

    def __init__(self) -> None:
        self.lateness_s: list[float] = []
        self.latency_s: list[float] = []

    def append(self, row: Mapping[str, float]) -> None:
        self.lateness_s.append(row["lateness_s"])
        self.latency_s.append(row["latency_s"])

    def event(self, time_s: float | None, level: str, text: str) -> None: ...

    def note(self, time_s: float | None, text: str) -> None: ...

    def state(self, time_s: float | None, text: str) -> None: ...


@contextmanager
def paced_device() -> Iterator[str]:
    """The virtual device in a process of its own, on a line of 115200 baud; yields its port."""
    command = [sys.executable, "-m", "app", "emulate", "--pace", "115200", "--json"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    try:
        yield json.loads(process.stdout.readline())["port"]
    finally:
        process.terminate()
        process.wait(timeout=10.0)


def one_round(port: str, seconds: float, folder: Path, mode: str) -> tuple[Columns, int, int]:
    """(times of every tick, overruns, missing ticks); recorded in `folder` and streamed as `mode` says."""
    from app.job import undisturbed
    from control.drive import OpenLoopDrive
    from control.loop import Loop, Sink
    from control.plan import Plan
    from control.row import columns_of
    from control.step import Step
    from hal.clock import RealClock
    from hal.modbus_bench import ModbusBench
    from hal.profile import load_profile
    from hal.safety import SafeBench
    from logs.stream import RunView
    from logs.writer import RunWriter

    clock, seen = RealClock(), Columns()
    profile = load_profile("virtual")
    aux = {name: register.unit for name, register in profile.signals.aux.items()}
    with ExitStack() as stack:
        bench = stack.enter_context(SafeBench(ModbusBench(profile, port, clock), profile.limits, clock))
        sinks: list[Sink] = [seen]
        columns, start = columns_of(bench.info, closed_loop=False, aux_units=aux), dict[str, object](kind="bench")
        if mode in ("record", "both"):
            sinks.append(stack.enter_context(RunWriter.create(folder, start, columns)))
        if mode in ("view", "both"):
            view = stack.enter_context(RunView.open(start, columns))
            assert view.on, view.trouble
            sinks.append(view)
        plan = Plan(PERIOD_S, (Step(0.0, 0.0, 0.0, 0.5), Step(9.0, 14.0, seconds - 0.5, seconds - 0.5)))
        stack.enter_context(undisturbed())  # as every run
        bench.arm()
        outcome = Loop(bench, clock, sinks, aux=tuple(aux)).run(plan, OpenLoopDrive())
    return seen, outcome.overruns, outcome.missing


def stolen_ms() -> float:
    """Processor time since the start that the host of this virtual machine gave to others, of all processors."""
    try:
        words = Path("/proc/stat").read_text(encoding="ascii").split("\n", 1)[0].split()
        return 1e3 * float(words[8]) / os.sysconf("SC_CLK_TCK")
    except (OSError, IndexError, ValueError):
        return 0.0


def p99(values: list[float]) -> float:
    return sorted(values)[int(0.99 * (len(values) - 1))]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=10.0, help="of each round")
    parser.add_argument("--rounds", type=int, default=3)
    asked = parser.parse_args()
    lateness: dict[str, list[list[float]]] = {mode: [] for mode in MODES}
    titles = (
        "recorded, shown",
        "ticks",
        "overruns",
        "missing",
        "late p50 ms",
        "p99",
        "max",
        "wire p50 ms",
        "p99",
        "stolen ms",
    )
    print("{:>15} {:>6} {:>9} {:>8} {:>12} {:>6} {:>6} {:>12} {:>6} {:>9}".format(*titles))
    with paced_device() as port, tempfile.TemporaryDirectory() as scratch:
        for number in range(len(MODES) * asked.rounds):
            mode = MODES[number % len(MODES)]
            before_ms = stolen_ms()
            seen, overruns, missing = one_round(port, asked.seconds, Path(scratch) / f"run{number}", mode)
            late, latency = [1e3 * x for x in seen.lateness_s], [1e3 * x for x in seen.latency_s]
            lateness[mode].append(late)
            print(
                f"{mode:>15} {len(late):6d} {overruns:9d} {missing:8d} {statistics.median(late):12.3f} "
                f"{p99(late):6.2f} {max(late):6.2f} {statistics.median(latency):12.3f} {p99(latency):6.2f} "
                f"{stolen_ms() - before_ms:9.0f}",
                flush=True,
            )
    report(lateness)


def report(lateness: dict[str, list[list[float]]]) -> None:
    for mode in MODES[1:]:
        all_rounds = [p99([x for late in lateness[each] for x in late]) for each in ("off", mode)]
        quietest = [min(p99(late) for late in lateness[each]) for each in ("off", mode)]
        print(
            f"p99 lateness, off and {mode:>6}: {all_rounds[0]:.3f} and {all_rounds[1]:.3f} ms over all rounds "
            f"({all_rounds[1] - all_rounds[0]:+.3f}), {quietest[0]:.3f} and {quietest[1]:.3f} ms in the quietest "
            f"({quietest[1] - quietest[0]:+.3f}); allowed +0.5 ms"
        )


if __name__ == "__main__":
    main()
