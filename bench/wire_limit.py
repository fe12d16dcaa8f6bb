"""How close a transaction comes to what the wire can carry: `python bench/wire_limit.py [--times N]`.

The virtual line emits every byte when its last bit would have crossed the wire, and starts to answer one t3.5 after
the request has. `ideal` is that time: both frames, and the silences that the master is asked to keep - one for masters
that leave out their own pause before the next request, two for those that keep it.
"""

from __future__ import annotations

import argparse
import statistics
from collections.abc import Callable
from contextlib import closing

from bench.coded_slave import coded_slave
from bench.masters import LibModbusMaster, Master, MinimalModbus, Ours, PymodbusAsync, PymodbusSync, libmodbus_there

BYTES = {"FC03": (8, 13), "FC23": (17, 13)}  # request and reply for 4 registers (and 2 written)
BITS = 10  # 8N1


class OursBySpec(Ours):
    name = "lostmotion, t3.5 kept"

    def __init__(self, port: str, timeout_s: float, baud: int) -> None:
        super().__init__(port, timeout_s, baud, pacing="spec")


def ideal_s(kind: str, baud: int, silences: int) -> float:
    from sim_device.framer import rtu_idle_s

    return sum(BYTES[kind]) * BITS / baud + silences * rtu_idle_s(baud)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--times", type=int, default=60)
    times = parser.parse_args().times
    makers: list[tuple[Callable[..., Master], int]] = [
        (OursBySpec, 2),
        (Ours, 1),
        (PymodbusAsync, 1),
        (PymodbusSync, 1),
    ]
    makers += [(MinimalModbus, 2)] + ([(LibModbusMaster, 1)] if libmodbus_there() else [])
    columns = ("baud", "kind", "master", "ideal ms", "median ms", "over ms", "p99 over", "ratio")
    print("{:>6} {:5} {:22} {:>9} {:>10} {:>8} {:>9} {:>6}".format(*columns))
    for baud in (9600, 19200, 115200):
        for make, silences in makers:
            with coded_slave("--pace", str(baud)) as port, closing(make(port, 0.5, baud)) as master:
                measure(master, baud, silences, times)


def measure(master: Master, baud: int, silences: int, times: int) -> None:
    for kind in BYTES:
        if kind not in master.kinds:
            continue
        master.durations_s((kind, 16, 4), 3)
        durations = sorted(master.durations_s((kind, 16, 4), times))
        ideal, middle = 1e3 * ideal_s(kind, baud, silences), 1e3 * statistics.median(durations)
        p99 = 1e3 * durations[int(0.99 * (len(durations) - 1))]
        print(
            f"{baud:6d} {kind:5} {master.name:22} {ideal:9.2f} {middle:10.2f} {middle - ideal:8.2f} "
            f"{p99 - ideal:9.2f} {middle / ideal:6.2f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
