"""What the readings alone say of a stem that was meant to rest: where it is on the mean, and how far it has swung.

A filter that takes the wrong thing for certain explains a miss away; a mean of readings cannot.
"""

from __future__ import annotations

from dataclasses import dataclass

from control.play_filter import Belief

SLOWEST = 0.03  # share of a new reading in the mean, which goes back over some 30 of them
LEAST = 20  # readings that a mean needs to count
GOING_IN = 0.0017  # a stem that is so far from where it goes is still on its way
SWING_IN, SIDE_IN, NOISES = 0.013, 0.006, 2.0  # a swing without a drive is as long, and as far on either side
IN_VAIN_PSI = 0.025  # pushed so far beyond the edge again and again, a plate that slides comes along
LATE_PSI = 0.06  # the same where readings are late
BEYOND_PSI = 0.022  # beyond an edge by so much, or by four standard deviations of a reading, a plate that slides moves


@dataclass(frozen=True, slots=True)
class Resting:
    """Mean of the readings less the target [in], and of how many, since the stem arrived; the furthest that it has been
    on either side of the target since the last drive [in]."""

    off_in: float = 0.0
    count: int = 0
    low_in: float = 0.0
    high_in: float = 0.0

    def read(self, reading_in: float, stem_in: float, goes_in: float) -> Resting:
        """After a reading of a stem that is thought to be at `stem_in` and to go to `goes_in`, all less the target."""
        low_in, high_in = min(self.low_in, stem_in), max(self.high_in, stem_in)
        if abs(goes_in - stem_in) > GOING_IN:
            return Resting(low_in=low_in, high_in=high_in)
        share = max(1.0 / (self.count + 1), SLOWEST)
        return Resting(self.off_in + share * (reading_in - self.off_in), self.count + 1, low_in, high_in)

    def swung(self, noise_in: float) -> bool:
        """Whether the stem has swung through the target, by more than pushing makes a plate go that slides, and than
        readings with this noise [in] can feign."""
        far_in = SWING_IN + NOISES * noise_in
        return self.high_in - self.low_in > far_in and min(self.high_in, -self.low_in) > SIDE_IN

    def stays(self, now: Belief, found: Belief, target_in: float, surely: float) -> bool:
        """Whether the stem is where it was, on the mean, though the pressure is beyond an edge as it was `found`, by
        `surely` standard deviations of that and more."""
        if self.count < LEAST:
            return False
        enough_psi, rest_in = max(BEYOND_PSI, 4.0 * now.noise_psi), target_in + self.off_in
        return any(
            side * (now.inside.p - found.edge_psi(rest_in, side)) - surely * found.edge_doubt_psi(side) > enough_psi
            for side in (1, -1)
        )


def in_vain(soon: Belief, mark: tuple[float, float, float], pushes: int, late: bool) -> bool:
    """Whether pushing the same way again and again has taken the pressure beyond where the edge was when it began, by
    more than that was in doubt, and the play output nowhere. What is pushed little by little drags the edge along in a
    belief, and a plate that sticks nowhere. Where readings are `late`, what is believed lags too, and more is asked."""
    way = 1 if pushes > 0 else -1
    went_psi, went_in = way * (soon.inside.p - mark[0]), way * (soon.inside.w - mark[1])
    least_psi, noises, surely = (LATE_PSI, 10.5, 1.0) if late else (IN_VAIN_PSI, 6.0, 2.5)
    visible_psi = max(least_psi, noises * soon.noise_psi) + surely * mark[2]
    return abs(pushes) > 3 and went_psi > visible_psi and went_in < 0.3 * soon.compliance * went_psi


def is_beyond(soon: Belief, found: Belief, grip_psi: float, surely: float) -> bool:
    """Whether the pressure is beyond an edge as it was `found`, by more than a grip, noise and the doubt of that edge,
    and the play output has not come along."""
    rest_psi = soon.inside.w / soon.compliance
    closing_psi = soon.inside.p - found.inside.a1 - rest_psi - surely * found.edge_doubt_psi(1)
    opening_psi = found.inside.a2 + rest_psi - soon.inside.p - surely * found.edge_doubt_psi(-1)
    return max(closing_psi, opening_psi) > max(grip_psi, 7.0 * soon.noise_psi)


def way_of_stroke(soon: Belief, off_in: float, room_in: float) -> int:
    """The way (+1 closing) of a stroke that corrects a miss of `off_in`: it ends on the opposite edge, which should be
    the one known better, and needs `room_in` before the end stop, or the plate would not let go on the way back."""
    if not room_in < soon.inside.w < soon.travel - room_in:
        return 1 if soon.inside.w < room_in else -1
    closing_in, opening_in = soon.edge_doubt_in(1), soon.edge_doubt_in(-1)
    if min(closing_in, opening_in) > 0.5 * max(closing_in, opening_in):
        return 1 if off_in > 0.0 else -1
    return 1 if opening_in < closing_in else -1
