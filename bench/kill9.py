"""The controller is killed in the middle of a run, again and again: `python bench/kill9.py [--times N] [--seed S]`.

A sweep in a process of its own drives the virtual device (real time, thesis plant) and is killed with SIGKILL at a
random moment. Then: how many ticks that the device has answered are missing from the record (the sequence register
counts them), and has the device's watchdog vented the valve?
"""

from __future__ import annotations

import argparse
import random
import signal
import struct
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sim_device.server import VirtualDevice

PERIOD_S = 0.02
COMMAND_PSI = 12.0
SETTLE_S = 3.0  # the watchdog of the virtual profile waits 2 s, then the pressure falls
SEQUENCE, STATUS, COMMAND, PRESSURE = 2, 3, 0, 4  # places in the block of registers from 16


@dataclass(frozen=True)
class Death:
    """What one kill left behind. `rows` are readable, `lost` are missing at the end; the valve's state at the end."""

    ran_s: float
    rows: int
    lost: int
    command_before_psi: float
    status: int
    command_after_psi: float
    pressure_after_psi: float

    @property
    def vented(self) -> bool:
        return self.status == 1 and self.command_after_psi == 0.0


def ask_device(port: str, clear: bool = False) -> Sequence[int]:
    """The block of registers from 16; with `clear`, switches the watchdog off and acknowledges it first."""
    from contextlib import closing

    from bench.masters import Ours
    from hal import pdu

    with closing(Ours(port, 0.5)) as master:
        if clear:
            master.transact(pdu.write_register(1, 32, 0))
            master.transact(pdu.write_register(1, 19, 1))
        return master.ask(("FC03", 16, 9))


def as_float(words: Sequence[int]) -> float:
    return float(struct.unpack(">f", struct.pack(">2H", *words))[0])


def one_death(device: VirtualDevice, folder: Path, run_s: float) -> Death:
    command = [sys.executable, "-m", "app", "sweep", "hold", "--port", device.port]
    command += ["--period", str(PERIOD_S), "--set", f"at={COMMAND_PSI}", "--set", "conditioning=false"]
    process = subprocess.Popen([*command, "--out", str(folder)], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    samples = folder / "samples.arrows"
    deadline = time.monotonic() + 30.0
    while not (samples.exists() and samples.stat().st_size > 0 and device.rig.command > 0.0):
        if process.poll() is not None or time.monotonic() > deadline:
            raise RuntimeError(f"the sweep did not start: {process.communicate()[1].decode()}")
        time.sleep(0.005)
    began = time.monotonic()
    time.sleep(run_s)
    before_psi = device.rig.command
    process.send_signal(signal.SIGKILL)
    process.wait()
    answered = device.rig.sequence
    ran_s = time.monotonic() - began
    time.sleep(SETTLE_S)
    block = ask_device(device.port)
    recorded, rows = last_sequence(folder)
    return Death(
        ran_s=ran_s,
        rows=rows,
        lost=(answered - recorded) & 0xFFFF,
        command_before_psi=before_psi,
        status=block[STATUS],
        command_after_psi=as_float(block[COMMAND : COMMAND + 2]),
        pressure_after_psi=as_float(block[PRESSURE : PRESSURE + 2]),
    )


def last_sequence(folder: Path) -> tuple[int, int]:
    """(the sequence number of the last readable row, the number of readable rows)."""
    from logs.run import read_run

    run = read_run(folder)
    assert run.status == "crash", f"a killed run reads as '{run.status}'"
    return int(run.columns["sequence"][-1]), run.rows


def main() -> None:
    from hal.clock import RealClock
    from hal.profile import load_profile
    from sim_device.physics.catalog import make_physics
    from sim_device.server import VirtualDevice

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--times", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    chance = random.Random(asked.seed)
    deaths: list[Death] = []
    plant = make_physics("thesis", asked.seed)
    with tempfile.TemporaryDirectory() as scratch, VirtualDevice(load_profile("virtual"), plant, RealClock()) as device:
        for number in range(asked.times):
            ask_device(device.port, clear=number > 0)
            deaths.append(one_death(device, Path(scratch) / f"run{number}", chance.uniform(0.3, 2.5)))
            print(f"{number + 1:3d}  {deaths[-1]}", flush=True)
    report(deaths)


def report(deaths: list[Death]) -> None:
    worst_s = max(death.lost for death in deaths) * PERIOD_S
    readable = sum(death.rows > 0 for death in deaths)
    whole = sum(death.lost * PERIOD_S <= 1.0 for death in deaths)
    vented = sum(death.vented for death in deaths)
    print(f"{len(deaths)} kills: {readable} records readable, {whole} up to the last second")
    print(f"worst: {worst_s:.2f} s of answered ticks are not in the record")
    print(f"valves vented by the device's watchdog: {vented} of {len(deaths)}")


if __name__ == "__main__":
    main()
