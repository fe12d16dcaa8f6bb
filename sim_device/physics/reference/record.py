"""The reference valve's build in SI units, with where the numbers come from, and the records its loop works on."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray

from sim_device.physics.imperfection import Chosen, Imperfection, fields, write

PSI = 6894.757293168  # Pa
INCH = 0.0254  # m
ATMOSPHERE = 101325.0  # Pa
GAS = 287.05 * 293.15  # J/kg, gas constant times room temperature
AREA = 49.0 * INCH * INCH  # m2; Warren Controls DL49: a 49 in2 diaphragm

RINGS = 5  # packing rings that can be soft
MEMORY = 256  # command changes that wait in the input card


@dataclass(frozen=True, slots=True)
class Build:
    """The healthy reference valve.

    Known: diaphragm area (Warren Controls DL49) and travel (thesis). Preload, spring rate and sliding friction follow
    from the thesis's table 2-1 and the area. Of literature's order: mass and Stribeck speed (Kayihan & Doyle 2000, and
    Garcia 2008, for a 100 in2 valve: 1.4 kg, 0.01 in/s). Air: ISO 6358, with conductances of the order that data sheets
    give for E/P converters of some 5 scfm and for 4 mm tube. The rest (volumes, presliding stiffness, the viscosity of
    the packing, hydraulic speed control, sensor electronics) is chosen here, plausible, not measured on any valve; with
    it the stem has the time constant and the highest speed of the thesis's.
    """

    # E/P converter
    supply: float = 20.0 * PSI  # Pa gauge
    nozzle_tau: float = 0.27  # s, signal chamber behind the nozzle
    booster_span: float = 0.12 * PSI  # Pa of signal error that opens a port fully
    booster_overlap: float = 0.0  # Pa
    port: float = 7.0e-9  # m3/(s Pa), sonic conductance of supply and exhaust port fully open
    port_b: float = 0.35  # critical pressure ratio
    line_volume: float = 1.5e-4  # m3, booster chamber and 3 m of tubing
    # tube between the converter and the diaphragm chamber
    tube: float = 2.4e-8  # m3/(s Pa)
    tube_b: float = 0.25
    tube_laminar: float = 0.99  # pressure ratio above which it flows laminar
    # actuator
    chamber_volume: float = 2.5e-4  # m3 with the valve fully open
    area_loss: float = 0.01  # share of the effective area that is lost over the stroke
    polytropic: float = 1.15
    preload: float = 7.316 * PSI * AREA  # N
    spring: float = 4.34e4  # N/m
    mass: float = 4.0  # kg
    travel: float = 0.5625 * INCH  # m
    stop_stiffness: float = 3.0e8  # N/m
    stop_damping: float = 3.0e5  # N s/m
    # the packing as LuGre bristles
    sliding: float = 1.4405 * PSI * AREA  # N
    breakaway: float = 1.02  # times sliding
    stribeck: float = 2.5e-4  # m/s
    bristle: float = 1.2e7  # N/m
    bristle_damping: float = 3.0e4  # N s/m
    viscous: float = 2.0e4  # N s/m
    # hydraulic speed control on the stem: oil through a gap, a flow regulator that bounds the speed, and a tapered
    # metering pin that closes the regulator towards the stop ahead, so that the stem lands softly
    damper: float = 1.0e5  # N s/m
    damper_speed: float = 0.118 * INCH  # m/s
    damper_taper: float = 2.7  # s, distance to the stop ahead over the speed that the pin lets through
    damper_over: float = 5.0e6  # N s/m above that speed
    coupling: float = 4.2e3  # N/m, of the elastic coupling that only a worn valve has
    # LVDT electronics
    filter_omega: float = 2.0 * np.pi * 25.0  # rad/s, second-order demodulator filter
    filter_damping: float = 0.8
    daq_period: float = 0.01  # s
    daq_step: float = INCH / 65536.0  # m, 16 bit over 1 in


STATE = np.dtype(
    [
        ("seed", "u8"),
        ("time", "f8"),
        ("reads", "i8"),
        ("queue_times", "f8", (MEMORY,)),
        ("queue_values", "f8", (MEMORY,)),
        ("queue_first", "i8"),
        ("queue_count", "i8"),
        ("command", "f8"),  # psi, as the converter's electronics see it
        ("newest", "f8"),
        ("flapper", "f8"),
        ("trim", "f8"),
        ("supply", "f8"),
        ("nozzle", "f8"),  # Pa gauge, as all pressures below
        ("line", "f8"),
        ("chamber", "f8"),
        ("unrest", "f8"),
        ("unrest_tick", "i8"),
        ("x", "f8"),
        ("v", "f8"),
        ("plug", "f8"),
        ("bristle", "f8"),
        ("rings", "f8", (RINGS,)),
        ("rest", "f8"),
        ("relax", "f8", (2,)),
        ("core", "f8"),
        ("side", "f8"),
        ("side_tick", "i8"),
        ("rod", "f8"),
        ("filtered", "f8"),
        ("filter_rate", "f8"),
        ("next_refresh", "f8"),
        ("refreshes", "i8"),
        ("shown", "f8"),
        ("gauge", "f8"),
    ]
)


def settings(known: tuple[Imperfection, ...], build: Build, chosen: list[Chosen], noise: float) -> NDArray[np.void]:
    """A settings record of shape (1,): the build, the noise factor, and size and form of every imperfection."""
    numbers = asdict(build)
    record = np.zeros(1, np.dtype([(name, "f8") for name in numbers] + [("noise", "f8"), *fields(known)]))
    for name, value in numbers.items():
        record[name] = value
    record["noise"] = noise
    write(record, chosen)
    return record


def start_state(seed: int) -> NDArray[np.void]:
    """A vented valve, fully open, at rest; shape (1,)."""
    state = np.zeros(1, STATE)
    state["seed"] = np.uint64(seed & 0xFFFFFFFFFFFFFFFF)
    state["unrest_tick"] = state["side_tick"] = -1
    state["supply"] = 20.0
    return state
