"""How far the healthy reference valve is from its own identified design: the floor of every blind check on it.

Run `python bench/reference_residual.py`. It plays six excitations without noise, fits the design's numbers to all of
them together, once as the design stands and once with the friction in motion, and prints the residual of each
excitation in percent of travel. The design is integrated here, in a third way, so that it leans on neither side.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from scipy.optimize import least_squares

from logs.recording import FloatArray
from sim_device.physics.catalog import make_physics
from sim_device.physics.offline import record

TRAVEL, EP_TAU, PERIOD_S = 0.5625, 0.28, 0.1
NAMES = ("compliance", "a1", "a2", "tau", "rate_limit")
START = np.array([0.19, 8.78, 5.82, 2.7, 0.12])


@njit(error_model="numpy")
def design(command: FloatArray, numbers: FloatArray, in_motion: bool) -> FloatArray:
    """Position [in] for a command [psi] per row, from a vented valve; `in_motion`: friction acts on the stem."""
    k, a1, a2, tau, rate = numbers
    half, middle = 0.5 * (a1 - a2), 0.5 * (a1 + a2)
    strain = k * half if in_motion else 0.0
    play = 0.0 if in_motion else half
    h = PERIOD_S / 20
    p = w = x = 0.0
    out = np.zeros(command.size)
    for row in range(1, command.size):
        for _ in range(20):
            p += (command[row] - p) * (1.0 - np.exp(-h / EP_TAU))
            w = min(max(k * (p - middle - play), min(k * (p - middle + play), w)), TRAVEL + strain)
            w = max(w, -strain)
            pull = max(w - x - strain, 0.0) - max(x - w - strain, 0.0)
            x = min(max(x + h * min(max(pull / tau, -rate), rate), 0.0), TRAVEL)
        out[row] = x
    return out


def excitations() -> dict[str, FloatArray]:
    """Commands [psi] by name, one value a row."""
    dice = np.random.default_rng(9)
    up = np.arange(4.0, 13.6, 0.25)
    inner = [9.0, 7.0, 9.8, 6.8, 10.6, 6.6, 11.4, 6.4, 12.2, 6.2, 11.5, 6.2, 10.5, 6.8, 10.0, 7.4, 4.0]
    time_s = np.arange(0.0, 400.0, PERIOD_S)
    lines = zip((0.005, 0.0125, 0.02, 0.0325, 0.05, 0.08), dice.uniform(0.0, 6.0, 6), strict=True)
    waves = [np.sin(2.0 * np.pi * f * time_s + phase) for f, phase in lines]
    return {
        "staircase, 0.25 psi every 10 s": np.repeat(np.r_[up, up[::-1]], 100),
        "nested reversals, 10 s each": np.repeat([4.0, 13.5, 4.0, *inner], 100),
        "ramp, 0.04 psi/s": np.interp(np.arange(0.0, 480.0, PERIOD_S), [0.0, 240.0, 480.0], [4.0, 13.5, 4.0]),
        "random steps, 25 s each": np.repeat(dice.uniform(5.0, 13.0, 20), 250),
        "random steps, 3 to 9 s": np.repeat(dice.uniform(5.0, 13.0, 60), dice.integers(30, 90, 60)),
        "multisine, 0.005 to 0.08 Hz": 9.0 + np.sum(waves, axis=0),
    }


def main() -> None:
    cases = {}
    for name, command in excitations().items():
        time_s = np.linspace(0.0, (command.size - 1) * PERIOD_S, command.size)
        cases[name] = (command, record(make_physics("reference", noise=0.0), time_s, command)[1])
    for title, in_motion in (("design", False), ("design with friction in motion", True)):

        def residual(numbers: FloatArray, in_motion: bool = in_motion) -> list[FloatArray]:
            return [100.0 / TRAVEL * (design(u, numbers, in_motion) - x) for u, x in cases.values()]

        fit = least_squares(
            lambda numbers, residual=residual: np.concatenate(residual(numbers)),
            START,
            diff_step=2e-3,
            x_scale=0.1 * START,
        )
        print(f"{title}: " + ", ".join(f"{name} {value:.4g}" for name, value in zip(NAMES, fit.x, strict=True)))
        print(f"  {'all together':32s} rms {np.sqrt(np.mean(fit.fun**2)):5.2f} % of travel")
        for name, error in zip(cases, residual(fit.x), strict=True):
            print(f"  {name:32s} rms {np.sqrt(np.mean(error**2)):5.2f}   largest {np.max(np.abs(error)):5.1f}")


if __name__ == "__main__":
    main()
