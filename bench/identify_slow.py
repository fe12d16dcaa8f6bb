"""How often the intervals of `identify` hold the truth where rows are seconds apart.

    python bench/identify_slow.py --period-s 2 --count 30

Valves are drawn at random (a converter's lag of 0.15 to 0.8 s, a stem's of 1.5 to 4 s, a rate limit of 0.06 to
0.2 in/s) and solved here in steps of a millisecond of the interface document's equations. `mixed` is 28 stairs and
random steps of 14 s, 1200 s together; `one_percent` goes up and down in steps of 1 % of the command's range, 20 s each.
Noise is white, 0.004 psi and 0.0006 in. Seeds like these were used to write the code.
"""

from __future__ import annotations

import click
import numpy as np
from numba import njit

from control.identify import identify
from hal.errors import BadInput, JobFailed
from logs.recording import FloatArray, Recording

_STEP_S, _TRAVEL_IN = 1e-3, 0.5625
_NOISE_PSI, _NOISE_IN = 0.004, 0.0006
#: What an estimate is compared with: the name of the truth that it is to hold.
_TRUTH = {"compliance": "k", "k1": "k", "k2": "k", "k_eq": "k", "tau (63 %)": "tau"}


@njit(nogil=True)
def _solve(u: FloatArray, period_s: float, per: int, v: FloatArray, pressure: FloatArray, stem: FloatArray) -> None:
    """Fills in pressure and stem at the rows; `u[i]` holds up to row i, `per` steps lie between two rows."""
    ep_tau, a1, a2, k, tau, rate, travel = v
    h = period_s / per
    kept = np.exp(-h / ep_tau)
    p, x, w = u[0], 0.0, 0.0
    pressure[0], stem[0] = p, x
    for i in range(1, u.size):
        for _ in range(per):
            p = u[i] + (p - u[i]) * kept
            w = min(max(k * (p - a1), min(k * (p - a2), w), 0.0), travel)
            x = min(max(x + min(max((w - x) / tau, -rate), rate) * h, 0.0), travel)
        pressure[i], stem[i] = p, x


def _command(kind: str, period_s: float, rng: np.random.Generator) -> FloatArray:
    """What is commanded [psi], one value per row."""
    if kind == "one_percent":
        levels = np.concatenate([np.arange(5.0, 12.6, 0.12), np.arange(12.6, 5.0, -0.12)])
        return np.repeat(levels, max(1, round(2600.0 / period_s / levels.size)))
    rows = int(1200.0 / period_s) + 1
    stairs = np.concatenate([np.linspace(5.0, 12.5, 14), np.linspace(12.5, 5.0, 14)])
    hold = max(1, round(14.0 / period_s))
    steps = np.repeat(rng.uniform(4.5, 13.0, rows // hold + 2), hold)
    return np.concatenate([np.repeat(stairs, max(1, int(600.0 / period_s) // 28)), steps])[:rows]


def drawn(kind: str, period_s: float, seed: int, measured: bool) -> tuple[dict[str, float], Recording]:
    """The truth and a record of it."""
    rng = np.random.default_rng(seed + 1000)
    ranges = {"ep.tau": (0.15, 0.8), "a1": (8.2, 9.2), "a2": (5.4, 6.6), "k": (0.16, 0.22), "tau": (1.5, 4.0)}
    truth = {name: float(rng.uniform(*ends)) for name, ends in (ranges | {"rate_limit": (0.06, 0.2)}).items()}
    truth |= {"travel": _TRAVEL_IN}
    u = _command(kind, period_s, rng)
    p, x = np.empty(u.size), np.empty(u.size)
    _solve(u, period_s, max(1, int(period_s / _STEP_S)), np.array(list(truth.values())), p, x)
    x += _NOISE_IN * rng.standard_normal(u.size)
    reading = p + _NOISE_PSI * rng.standard_normal(u.size) if measured else None
    truth["deadband"] = truth["a1"] - truth["a2"]
    return truth, Recording(f"{kind}-{seed}", period_s * np.arange(float(u.size)), u, x, reading)


def coverage(kind: str, period_s: float, seeds: range, measured: bool) -> dict[str, list[tuple[bool, float]]]:
    """Per number of the fit, and the 63 % rule: whether its interval held, and half its width in percent of the truth.

    A number that was kept at its default has none and is left out.
    """
    found: dict[str, list[tuple[bool, float]]] = {}
    for seed in seeds:
        truth, recording = drawn(kind, period_s, seed, measured)
        try:
            estimates = identify([recording]).estimates
        except (BadInput, JobFailed) as error:
            click.echo(f"{recording.name}: {error}", err=True)
            continue
        for each in estimates:
            true = truth.get(_TRUTH.get(each.name, each.name))
            if each.interval is not None and true is not None:
                half = 100.0 * each.interval.half_width / true
                found.setdefault(each.name, []).append((each.interval.holds(true), half))
    return found


@click.command()
@click.option("--period-s", default=2.0, show_default=True)
@click.option("--count", default=30, show_default=True, help="Seeds of each kind.")
def main(period_s: float, count: int) -> None:
    for kind in ("mixed", "one_percent"):
        for measured in (True, False):
            found = coverage(kind, period_s, range(count), measured)
            click.echo(f"{kind}, {'with' if measured else 'without'} pressure, a row every {period_s:g} s")
            for name, rows in found.items():
                held, half = sum(ok for ok, _ in rows), float(np.median([width for _, width in rows]))
                click.echo(f"  {name:12s} held {held} of {len(rows)}, half width {half:.3g} % in the median")
            fit = [ok for name, rows in found.items() for ok, _ in rows if "%" not in name]
            click.echo(f"  all of the fit {sum(fit)} of {len(fit)}")


if __name__ == "__main__":
    main()
