"""Bumpless hand-over for laws without an integrator: the first difference to the command in force fades out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

from control.exact import decay


@dataclass(frozen=True, slots=True)
class Bump:
    """What is still added to the law's own command, `left_psi` [psi]."""

    left_psi: float

    @classmethod
    def from_command(cls, in_force_psi: float, law_psi: float) -> Self:
        return cls(in_force_psi - law_psi)

    def fade(self, dt_s: float, blend_s: float) -> Self:
        """The bump after `dt_s`, with the time constant `blend_s` [s]; gone at once for `blend_s` = 0."""
        return type(self)(self.left_psi * decay(dt_s / blend_s) if blend_s > 0.0 else 0.0)
