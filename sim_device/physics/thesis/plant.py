"""Family A: the thesis's plant, from its force balance, with every imperfection switchable."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from hal.errors import BadInput
from sim_device.physics.imperfection import Imperfection, choose
from sim_device.physics.thesis import command_line, converter, friction, gauge, reading, spring, stem
from sim_device.physics.thesis.loop import advance
from sim_device.physics.thesis.record import DesignNumbers, settings, start_state
from sim_device.valve import Outputs

IMPERFECTIONS: tuple[Imperfection, ...] = (
    *command_line.IMPERFECTIONS,
    *converter.IMPERFECTIONS,
    *friction.IMPERFECTIONS,
    *spring.IMPERFECTIONS,
    *stem.IMPERFECTIONS,
    *gauge.IMPERFECTIONS,
    *reading.IMPERFECTIONS,
)


class ThesisValve:
    """E/P lag, play between the curves, lag, rate limit and stops, integrated in steps of at most 5 ms.

    Deterministic: what it says is a function of the seed and of the calls. Command in psi.
    """

    def __init__(self, seed: int, design: DesignNumbers, effects: Mapping[str, float], noise: float) -> None:
        self.design = design
        self.settings = settings(IMPERFECTIONS, design, choose(IMPERFECTIONS, effects), noise)
        self.state = start_state(seed)
        self._now_s: float | None = None
        # compiled here and not at the first request, whose master would not wait for it
        advance(self.settings, self.state.copy(), 0.0, 0.0)

    def advance(self, to_time_s: float, command: float) -> Outputs:
        duration_s = 0.0 if self._now_s is None else max(to_time_s - self._now_s, 0.0)
        self._now_s = to_time_s if self._now_s is None else max(to_time_s, self._now_s)
        pressure_psi, position_in = advance(self.settings, self.state, float(command), duration_s)
        return Outputs(pressure_psi, position_in, float(self.state["supply"][0]), 22.0)


def checked_design(numbers: Mapping[str, float], others: Iterable[str] = ()) -> DesignNumbers:
    """Design numbers with some replaced; `others` are what the plant has besides, for the message.

    Raises: `BadInput` for an unknown name, or numbers that make no valve.
    """
    unknown = sorted(set(numbers) - set(DesignNumbers.__dataclass_fields__))
    if unknown:
        known = ", ".join((*DesignNumbers.__dataclass_fields__, *others))
        raise BadInput(f"option '{unknown[0]}' is not known to this plant; its numbers are {known}")
    design = DesignNumbers(**{name: float(value) for name, value in numbers.items()})
    for name in ("ep_tau", "compliance", "tau", "rate_limit", "travel"):
        if not getattr(design, name) > 0.0:
            raise BadInput(f"option '{name}' is {getattr(design, name)}; it must be above 0")
    if not design.a1 >= design.a2 > 0.0:
        raise BadInput(f"options a1 = {design.a1} and a2 = {design.a2} psi: a1 must not be below a2, and a2 above 0")
    return design
