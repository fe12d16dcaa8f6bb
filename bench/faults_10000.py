"""Reads over a bad line, side by side: `python bench/faults_10000.py [--hard | --tcp] [--reads N] [--seed S]`.

5 % late replies (0.9 to 3.5 x timeout), 5 % noise before, 3 % bit flips, 2 % drops, 3 % truncations, drawn
independently. Every read asks for 4 registers at a random address, and every register holds its own address: what a
master hands out is right, or it is silently wrong. Errors that a master raises are honest, and counted apart. `--tcp`
asks over Modbus TCP and disturbs what a gateway can: late, lost, cut and mislabelled answers, and exceptions.
"""

from __future__ import annotations

import argparse
import random
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from contextlib import closing

from bench.coded_slave import coded_slave
from bench.masters import LibModbusMaster, Master, MinimalModbus, Ours, PymodbusAsync, PymodbusSync, libmodbus_there
from bench.masters_tcp import OursTcp, PymodbusTcpAsync, PymodbusTcpSync

MIX = ("late=0.05:0.9-3.5", "noise_before=0.05", "bit_flip=0.03", "drop=0.02", "truncate=0.03")
MORE = ("noise_after=0.05", "wrong_unit=0.03", "wrong_function=0.03", "exception=0.02:6x3")
MAKERS: dict[str, Callable[[str, float], Master]] = {
    "lostmotion": Ours,
    "pymodbus sync": PymodbusSync,
    "pymodbus sync, 3 retries": lambda port, timeout_s: PymodbusSync(port, timeout_s, retries=3),
    "pymodbus async": PymodbusAsync,
    "pymodbus async, 3 retries": lambda port, timeout_s: PymodbusAsync(port, timeout_s, retries=3),
    "minimalmodbus": MinimalModbus,
    "libmodbus": LibModbusMaster,
    "libmodbus + recovery": lambda port, timeout_s: LibModbusMaster(port, timeout_s, recover=True),
}
MIX_TCP = ("late=0.05:0.9-3.5", "drop=0.02", "truncate=0.03", "wrong_transaction=0.03", "wrong_unit=0.02",
           "wrong_function=0.02", "exception=0.01:6x3")  # fmt: skip
MIXES = {"plain": MIX, "hard": MIX + MORE, "tcp": MIX_TCP}
MAKERS_TCP: dict[str, Callable[[str, float], Master]] = {
    "lostmotion": OursTcp,
    "pymodbus sync": PymodbusTcpSync,
    "pymodbus async": PymodbusTcpAsync,
}


def trial(name: str, reads: int, timeout_s: float, seed: int, kind: str) -> tuple[str, int, int, int, float, str]:
    """(master, right, raised, silently wrong, seconds, the master's own counters)."""
    mixed, make = kind != "plain", (MAKERS_TCP if kind == "tcp" else MAKERS)[name]
    kinds = ["FC03", "FC03", "FC23"] if mixed and name != "minimalmodbus" else ["FC03"]
    arguments = [word for fault in MIXES[kind] for word in ("--fault", fault)] + ["--tcp"] * (kind == "tcp")
    chance = random.Random(seed)
    right = raised = wrong = 0
    began = time.monotonic()
    slave = coded_slave(*arguments, "--timeout", str(timeout_s), "--seed", str(seed))
    with slave as port, closing(make(port, timeout_s)) as master:
        for _ in range(reads):
            address, count = chance.randrange(60_000), chance.choice((2, 4, 4, 4, 9)) if mixed else 4
            try:
                registers = master.ask((chance.choice(kinds), address, count))
            except Exception:  # whatever a master raises, it has not handed out a wrong value
                raised += 1
                continue
            correct = list(registers) == list(range(address, address + count))
            right, wrong = right + correct, wrong + (not correct)
        counters = getattr(master, "stats", {})
    shown = ", ".join(f"{key} {value}" for key, value in counters.items() if value)
    return name, right, raised, wrong, time.monotonic() - began, shown


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--reads", type=int, default=10_000)
    parser.add_argument("--timeout", type=float, default=0.03)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=4, help="masters at work at the same time; they mostly wait")
    parser.add_argument("--hard", action="store_true", help="more kinds of faults; mixed lengths and functions")
    parser.add_argument("--tcp", action="store_true", help="over Modbus TCP; mixed lengths and functions")
    parser.add_argument("--only", action="append", choices=list(MAKERS))
    asked = parser.parse_args()
    kind = "tcp" if asked.tcp else "hard" if asked.hard else "plain"
    there = MAKERS_TCP if asked.tcp else MAKERS
    names = asked.only or [name for name in there if libmodbus_there() or "libmodbus" not in name]
    print(f"{asked.reads} reads, timeout {1e3 * asked.timeout:g} ms, {', '.join(MIXES[kind])}")
    print(f"{'master':26} {'right':>7} {'raised':>7} {'SILENTLY WRONG':>15} {'seconds':>8}")
    with ProcessPoolExecutor(asked.jobs) as pool:
        jobs = [pool.submit(trial, name, asked.reads, asked.timeout, asked.seed, kind) for name in names]
        for job in jobs:
            name, right, raised, wrong, seconds, counters = job.result()
            print(f"{name:26} {right:7d} {raised:7d} {wrong:15d} {seconds:8.0f}   {counters}", flush=True)


if __name__ == "__main__":
    main()
