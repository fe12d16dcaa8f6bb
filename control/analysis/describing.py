"""Describing functions: the first harmonic of a nonlinear element's answer to a sine, over the sine.

Source: Gelb and Vander Velde, "Multiple-Input Describing Functions and Nonlinear System Design", 1968, appendix B.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

ComplexArray = npt.NDArray[np.complex128]
FloatArray = npt.NDArray[np.float64]


def play_describing_function(amplitude: FloatArray, width: float, slope: float) -> ComplexArray:
    """The play's N(A); zero for amplitudes up to half its width.

    `amplitude` and `width` in input units [psi] (the whole deadband, a1 - a2), `slope` in output per input [in/psi].
    """
    half = 0.5 * width
    r = half / np.maximum(np.asarray(amplitude, dtype=float), half)
    q = 1.0 - 2.0 * r
    real = (np.pi / 2.0 + np.arcsin(q) + 2.0 * q * np.sqrt(r * (1.0 - r))) / np.pi
    imaginary = -4.0 * r * (1.0 - r) / np.pi
    n: ComplexArray = slope * (real + 1j * imaginary)
    return n


def play(wave: FloatArray, width: float, slope: float) -> FloatArray:
    """The play's settled answer to one period of a wave, shape (n,): gone through twice, the second time counts."""
    half, z = 0.5 * width, float(wave[0])
    out = np.empty_like(wave)
    for _ in range(2):
        for i, u in enumerate(wave):
            z = min(max(z, u - half), u + half)
            out[i] = slope * z
    return out


def first_harmonic(wave: FloatArray) -> complex:
    """The complex amplitude of the first harmonic of one period, for the phase of a cosine."""
    return complex(2.0 * np.fft.rfft(wave)[1] / wave.size)


def play_numerically(amplitude: float, width: float, slope: float, n: int = 4096) -> complex:
    """N(A) from a sampled sine: the check of the closed form."""
    angle = 2.0 * np.pi * np.arange(n) / n
    return first_harmonic(play(amplitude * np.cos(angle), width, slope)) / amplitude


def saturation_describing_function(amplitude: FloatArray, limit: float) -> FloatArray:
    """N(A) of a unit-slope saturation at +-limit; real. For the rate limiter, in front of its integrator."""
    a = np.maximum(np.asarray(amplitude, dtype=float), limit)
    r = limit / a
    n: FloatArray = 2.0 / np.pi * (np.arcsin(r) + r * np.sqrt(1.0 - r**2))
    return n
