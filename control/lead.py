"""A command beyond the pressure that is wanted, so that a converter with a lag gets there within a tick."""

from __future__ import annotations

from control.exact import lag
from control.observer import Inside

MOST = 3.5  # times the way to the aim
IN_DEAD_TIME = 0.96  # of it, where a dead time is known to a part of a tick: not beyond the aim
NEAR_PSI = 0.05  # of the aim, from where on the command is that of the aim itself
#: Per tick that the bench has to let commands change: a command beyond the aim that cannot be back in time takes the
#: pressure beyond it, too, and the stem with it.
SLEW_PSI = 6.0


def command_toward(
    inside: Inside, aim_psi: float, limits: tuple[float, float], dt_s: float, ep_tau_s: float, *, calm: bool
) -> float:
    """The command that brings the pressure to the aim within a tick, if the bench lets it and nothing is `calm` [psi].

    `limits`: the command in force [psi], and how fast the bench lets it change [psi/s].
    """
    away_psi, (from_psi, slew_psi_per_s) = aim_psi - inside.p, limits
    lead = min(1.0 / lag(dt_s, ep_tau_s), MOST)
    lead *= IN_DEAD_TIME if inside.line.ticks > 0.0 else 1.0
    slew_psi = slew_psi_per_s * dt_s
    leads = abs(away_psi) > NEAR_PSI and not calm and slew_psi > SLEW_PSI
    wanted_psi = inside.command_for(inside.p + (lead if leads else 1.0) * away_psi)
    return min(max(wanted_psi, from_psi - slew_psi), from_psi + slew_psi)
