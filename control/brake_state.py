"""What the controller `brake` remembers from tick to tick."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from control.grip import Grip
from control.lateness import Lateness
from control.play_filter import Belief
from control.resting import Resting


@dataclass(frozen=True, slots=True)
class BrakeState:
    """The belief for the next reading; `drive` is +1 closing, -1 opening, 0 settling; the aim [psi], and for how long
    it has not changed [s]; the belief when the edges were last known well; whether the valve sticks; how often it has
    been turned back or stroked for this target; whether it is being pushed, and how often the same way (+ closing); how
    long the drive has lasted [s], and from where [in]; edge [psi], play output [in] and doubt of the edge [psi] when
    the pushing began; what the readings say of the rest since the last drive; how late they are; whether it slides; how
    far beyond the near edge the detour under way goes (0: none is) [psi], and how many this target has had."""

    belief: Belief
    target_in: float
    aim_psi: float
    drive: int = 0
    quiet_s: float = 0.0
    found: Belief | None = None
    sticks: bool = False
    turns: int = 0
    pushing: bool = False
    pushes: int = 0
    driven_s: float = 0.0
    from_in: float = 0.0
    mark: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rest: Resting = field(default_factory=Resting)
    late: Lateness = field(default_factory=Lateness)
    grip: Grip = field(default_factory=Grip)
    over_psi: float = 0.0
    detours: int = 0

    def at(self, target_in: float) -> BrakeState:
        """With a new target, for which nothing has been tried."""
        afresh = replace(self, target_in=target_in, turns=0, pushes=0, rest=Resting(), grip=Grip())
        return replace(afresh, over_psi=0.0, detours=0)
