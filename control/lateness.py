"""How late the readings of the stem are behind those of the pressure, from how moves begin.

Late readings make a plate that slides look like one that sticks and jumps: the pressure is beyond the edge, and nothing
moves; later it moves, when nothing pushes any more. A grip costs a move at full speed a few hundredths of a second,
because its pressure rises by tens of psi per second; late readings cost it all that they are late.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from control.observer import Inside, Observer, follow

PROMPT_S = 0.08  # less than that is how a move begins, not how late it is seen
GONE_IN = 0.012  # a move has begun when it is so far from where it started
REST_IN, FAR_IN = 0.002, 0.02  # nearer to where it goes, a stem rests; shorter moves show little
LONG_S = 3.0  # a move that has not begun after so long says nothing
PARTS = 4  # of a tick, in which the pressure goes in a straight line from reading to reading


@dataclass(frozen=True, slots=True)
class Lateness:
    """How late moves were in beginning, on the mean [s], and how many. Of one that begins: which way (0: none does),
    from where [in], the pressure of the edge there [psi], for how long, how far the readings have gone [in], play
    output and stem as the pressure has them, less where they began [in], the last pressure [psi], and when the stem
    should have gone `GONE_IN` [s]."""

    late_s: float = 0.0
    count: int = 0
    way: int = 0
    from_in: float = 0.0
    edge_psi: float = 0.0
    since_s: float = 0.0
    gone_in: float = 0.0
    w_in: float = 0.0
    x_in: float = 0.0
    psi: float = 0.0
    due_s: float | None = None

    @property
    def known_s(self) -> float:
        """How late readings are beyond doubt [s]."""
        return 0.0 if self.late_s < PROMPT_S else self.late_s

    @property
    def awaited(self) -> bool:
        """Whether readings may be late by nobody knows how much, because the first move has not been seen to begin."""
        return self.way != 0 and self.count == 0

    def begun(self, way: int, inside: Inside, edge_psi: float, target_in: float, psi: float) -> Lateness:
        """A move that begins, watched if it is long and from rest; `edge_psi` pushes the stem from where it is."""
        if abs(inside.w - inside.x) > REST_IN or abs(target_in - inside.x) < FAR_IN:
            return self
        return Lateness(self.late_s, self.count, way, inside.x, edge_psi, psi=psi)

    def read(self, observer: Observer, reading_in: float, psi: float, dt_s: float) -> Lateness:
        """After the next readings."""
        if not self.way:
            return self
        d, w_in, x_in, since_s = observer.design, self.w_in, self.x_in, self.since_s + dt_s
        for part in range(1, PARTS + 1):
            beyond_psi = self.way * (self.psi + (psi - self.psi) * part / PARTS - self.edge_psi)
            w_in = max(w_in, d.compliance * beyond_psi)
            x_in = follow(x_in, w_in, d.tau_s, d.rate_limit, dt_s / PARTS)
        gone_in, due_s = self.way * (reading_in - self.from_in), self.due_s
        if due_s is None and x_in > GONE_IN:
            due_s = since_s - dt_s * _left(self.x_in, x_in)
        if since_s > LONG_S:
            return Lateness(self.late_s, self.count)
        if gone_in > GONE_IN and due_s is not None:
            seen_s = since_s - dt_s * _left(self.gone_in, gone_in) if self.gone_in < GONE_IN else due_s
            count = self.count + 1
            return Lateness(self.late_s + (seen_s - due_s - self.late_s) / count, count)
        return replace(self, since_s=since_s, gone_in=gone_in, w_in=w_in, x_in=x_in, psi=psi, due_s=due_s)


def _left(before_in: float, now_in: float) -> float:
    """The share of the last tick that was left when it had gone `GONE_IN`."""
    return (now_in - GONE_IN) / (now_in - before_in)
