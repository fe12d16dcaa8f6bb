"""What `lostmotion check` finds out about a bench."""

from __future__ import annotations

import math
import statistics
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from app.readings import quality_text

if TYPE_CHECKING:
    from app.session import Session
    from hal.modbus_bench import ModbusBench

_READS = 20
_FILL_S, _HOLD_S, _TICK_S = 10.0, 20.0, 0.1
_LEAK_SHARE = 0.02  # of the command range: more pressure error or drift than this is a leak or a starved supply
_SUPPLY_SHARE = 0.05  # of itself: more sag under load than this


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing that was looked at. `numbers` are for scripts; `remark`: nothing is broken, and yet it matters."""

    name: str
    ok: bool
    text: str
    numbers: Mapping[str, object] = field(default_factory=dict)
    remark: bool = False


def look(bench: ModbusBench, period_s: float | None) -> list[Finding]:
    """Everything that can be known without writing."""
    return [_identity(bench), _line(bench, period_s), *_signals(bench), _calibration(bench), *_safe(bench)]


def _identity(bench: ModbusBench) -> Finding:
    said = dict(bench.info.identity)
    text = ", ".join(f"{name} {value}" for name, value in said.items()) or "the profile does not say how to tell"
    return Finding("identity", True, f"{bench.profile.title or bench.profile.name}: {text}", {"identity": said})


def _line(bench: ModbusBench, period_s: float | None) -> Finding:
    latencies_ms = sorted(1e3 * bench.observe().position.latency_s for _ in range(_READS))
    least_s, stats = bench.info.min_period_s, bench.bus.stats
    middle_ms = statistics.median(latencies_ms)
    clean = stats.timeouts == 0 and stats.noise_bytes == 0
    fits = period_s is None or period_s >= least_s
    text = f"{bench.info.port}: shortest tick {1e3 * least_s:.2f} ms, a read takes {middle_ms:.2f} ms"
    if period_s is not None:
        text += f"; a tick of {1e3 * period_s:g} ms " + ("fits" if fits else "is more than it can carry")
    text += "" if clean else f"; {stats.timeouts} timeouts, {stats.noise_bytes} bytes of noise: look at the cable"
    numbers = {"min_period_s": least_s, "read_ms": middle_ms, "worst_read_ms": latencies_ms[-1], **stats.as_dict()}
    return Finding("line", fits and clean, text, numbers)


def _signals(bench: ModbusBench) -> list[Finding]:
    from hal.sample import Quality

    sample = bench.observe()
    readings = {"position": (sample.position, "in"), "pressure": (sample.pressure, "psi")}
    readings |= {
        name: (sample.aux[name], register.unit)
        for name, register in bench.profile.signals.aux.items()
        if name in sample.aux
    }
    found = []
    for name, (reading, unit) in readings.items():
        if reading is not None:
            value = None if math.isnan(reading.value) else reading.value
            text = f"{'no value' if value is None else f'{value:.4g} {unit}'} ({quality_text(reading.quality)})"
            # An unsigned converter cannot show less than nothing: that is where the pressure of a vented valve stands.
            vented = name == "pressure" and reading.quality == Quality.SATURATED and reading.value <= 0.0
            found.append(Finding(name, vented or not reading.quality, text, {"value": value, "unit": unit}))
    status = sample.aux.get("watchdog_status")
    if status is not None and status.value != 0:
        text = "the device ignores commands after a timeout or stop; `lostmotion set --acknowledge` lifts that"
        found.append(Finding("watchdog", False, text, {"status": status.value}))
    return found


def _calibration(bench: ModbusBench) -> Finding:
    from hal.clock import utc_now

    calibration = bench.profile.calibration
    if calibration is None:
        return Finding("calibration", True, "the position register is in inches already")
    expired = calibration.expired(utc_now().date())
    until = (
        "no expiry"
        if calibration.expires is None
        else f"{'EXPIRED' if expired else 'good until'} {calibration.expires}"
    )
    text = f"'{calibration.id}' of {calibration.made} ({calibration.instrument or 'instrument not named'}), {until}"
    numbers = {"id": calibration.id, "expires": None if calibration.expires is None else str(calibration.expires)}
    return Finding("calibration", not expired, text, numbers)


def _safe(bench: ModbusBench) -> list[Finding]:
    profile = bench.profile
    setup = profile.device_of(profile.signals.command).watchdog
    guard = "" if setup is None else f"; the device's watchdog acts after {setup.timeout_s:g} s"
    kept = f"vents to {profile.safe_command:g} {profile.command_unit}" if profile.safe_direction == "vent" else "holds"
    numbers = {"safe_command": profile.safe_command, "safe_direction": profile.safe_direction}
    found = [Finding("safe state", True, f"at the end the valve {kept}{guard}", numbers)]
    if setup is None:
        text = (
            "none in the profile: when the cable, the power or this program fails at once (SIGKILL), nobody sends the "
            "safe command and the valve keeps its last one; shut off the supply"
        )
        found.append(Finding("no watchdog", True, text, remark=True))
    return found


def pressurise(session: Session) -> list[Finding]:
    """Holds the middle of the range: does the pressure arrive and stay, and does the supply sag? Moves the valve."""
    info = session.bench.info
    command = 0.5 * (info.command_min + info.command_max)
    start = session.bench.exchange(info.safe_command).aux.get("supply_psi")
    times, pressures, supplies = _hold(session, command)
    found = []
    if len(pressures) > 2:
        slope, _ = statistics.linear_regression(times, pressures)
        # Where the command is a position, the pressure belongs to the positioner and has no target of its own.
        error = statistics.fmean(pressures) - command if info.command_unit == "psi" else 0.0
        drift = abs(slope) * (times[-1] - times[0])
        allowed = _LEAK_SHARE * (info.command_max - info.command_min) if info.command_unit == "psi" else 0.4
        held = f"held {command:g} {info.command_unit} for {times[-1] - times[0]:.0f} s"
        leak = Finding("leak", drift <= allowed, f"{held}: drifts {slope:+.4f} psi/s", {"drift_psi_s": slope})
        text = f"{held}: the pressure is off by {error:+.3f} psi (allowed {allowed:g})"
        found += [leak, Finding("converter", abs(error) <= allowed, text, {"error_psi": error})]
    if start is not None and supplies:
        sag = start.value - min(supplies)
        text = f"{start.value:.2f} psi before, lowest {min(supplies):.2f} psi under load"
        numbers = {"before_psi": start.value, "lowest_psi": min(supplies)}
        found.append(Finding("supply", sag <= _SUPPLY_SHARE * start.value, text, numbers))
    if not found:
        found.append(Finding("leak", True, "the profile has neither a pressure nor a supply reading to judge by"))
    return found


def _hold(session: Session, command: float) -> tuple[list[float], list[float], list[float]]:
    """(times, pressures) after filling, and the supply all along."""
    from hal.safety import UNTRUSTED
    from hal.signals import stop_signals

    bench, clock = session.bench, session.clock
    tick_s = max(_TICK_S, bench.info.min_period_s)
    began_s, count = clock.now_s(), int((_FILL_S + _HOLD_S) / tick_s)
    times: list[float] = []
    pressures: list[float] = []
    supplies: list[float] = []
    with stop_signals() as stop:
        for tick in range(count):
            stop.check()
            clock.sleep_until(began_s + tick * tick_s)
            sample = bench.exchange(command)
            supply = sample.aux.get("supply_psi")
            if supply is not None and not supply.quality & UNTRUSTED:
                supplies.append(supply.value)
            filled = clock.now_s() - began_s >= _FILL_S
            if filled and sample.pressure is not None and not sample.pressure.quality & UNTRUSTED:
                times.append(sample.pressure.time_s - began_s)
                pressures.append(sample.pressure.value)
    return times, pressures, supplies
