"""How long one transaction takes over a pseudo-terminal, side by side: `python bench/transaction.py [--rounds N]`.

Every master has a slave of its own in another process; blocks of repetitions are interleaved in random order, so that
whatever else the machine does falls on all alike. Ours leaves out the t3.5 pause here, as all the others do except
minimalmodbus: a pseudo-terminal has no bits.
"""

from __future__ import annotations

import argparse
import random
import statistics
from contextlib import ExitStack

from bench.coded_slave import coded_slave
from bench.masters import LibModbusMaster, Master, MinimalModbus, Ours, PymodbusAsync, PymodbusSync, libmodbus_there

BLOCK = 100
SLOW_BLOCK = 10  # for masters that sleep milliseconds


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=12)
    rounds = parser.parse_args().rounds
    kinds = [Ours, PymodbusAsync, PymodbusSync, MinimalModbus] + ([LibModbusMaster] if libmodbus_there() else [])
    with ExitStack() as stack:
        masters: list[Master] = []
        for kind in kinds:
            masters.append(kind(stack.enter_context(coded_slave()), 0.5))
            stack.callback(masters[-1].close)
        taken = measure(masters, rounds)
    report(taken, [master.name for master in masters])


def measure(masters: list[Master], rounds: int) -> dict[tuple[str, str], list[list[float]]]:
    """Durations [s], round by round, by (master, kind of transaction)."""
    jobs = [(master, kind) for master in masters for kind in master.kinds]
    taken: dict[tuple[str, str], list[list[float]]] = {(master.name, kind): [] for master, kind in jobs}
    chance = random.Random(1)
    for number in range(rounds + 1):
        chance.shuffle(jobs)
        for master, kind in jobs:
            slow = isinstance(master, (PymodbusSync, MinimalModbus))
            durations = master.durations_s((kind, 16, 4), SLOW_BLOCK if slow else BLOCK)
            if number:  # the first round warms up
                taken[(master.name, kind)].append(durations)
    return taken


def report(taken: dict[tuple[str, str], list[list[float]]], names: list[str]) -> None:
    """All repetitions, and the quietest round of each: what remains when the machine has nothing else to do."""
    yardstick = LibModbusMaster.name if LibModbusMaster.name in names else Ours.name
    titles = ("master", "kind", "n", "median us", "p99 us", "ratio", "quietest us", "ratio")
    print("{:20} {:5} {:>6} {:>10} {:>9} {:>6} {:>12} {:>6}".format(*titles))
    for kind in ("FC03", "FC16", "FC23"):
        base, quiet_base = _middles(taken[(yardstick, kind)])
        for name in names:
            rounds = taken.get((name, kind))
            if not rounds:
                continue
            every = sorted(duration for durations in rounds for duration in durations)
            middle, quiet = _middles(rounds)
            print(
                f"{name:20} {kind:5} {len(every):6d} {middle:10.1f} {1e6 * every[int(0.99 * (len(every) - 1))]:9.1f} "
                f"{middle / base:6.2f} {quiet:12.1f} {quiet / quiet_base:6.2f}"
            )


def _middles(rounds: list[list[float]]) -> tuple[float, float]:
    """Median of everything, and the least median of a round [us]."""
    everything = [duration for durations in rounds for duration in durations]
    return 1e6 * statistics.median(everything), 1e6 * min(statistics.median(durations) for durations in rounds)


if __name__ == "__main__":
    main()
