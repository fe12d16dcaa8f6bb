"""How far the search over hypotheses goes."""

from __future__ import annotations

from dataclasses import dataclass

#: Mean squared residual of the design, noise = 1, up to which a signal passes for healthy: 1.3 times the noise.
SLIGHT = 1.69


@dataclass(frozen=True, slots=True)
class SearchRules:
    """How far the search goes. `beam`: hypotheses that are extended by one more cause; `most`: causes at the most."""

    beam: int = 4
    most: int = 3
    rounds: int = 6
    polish: int = 8
    threads: int = 2
    paired: int = 6  # pairs that get a full fit because their moves add up well, from each point that is looked from
    screened: int = 5  # further causes per hypothesis of the beam that get a full fit,
    forms: int = 3  # each in so many forms at the most
    reformed: int = 8  # pairs whose members are tried in their other forms, of which
    other_forms: int = 8  # get a full fit each,
    reform_share: float = 0.002  # where the likeliest pair leaves more than this share of what the design leaves,
    bent: float = 4.0  # or moves its design numbers by more than this (squares of their priors' deviations)
    enough: float = 1.25  # a mean squared residual (noise = 1) that leaves nothing to explain
    enough_share: float = 0.0003  # likewise, as a share of what the design leaves
    stuck: float = 0.5  # a share of what a hypothesis leaves, below which it is fitted again from one with a cause more
    restless: float = 0.5  # the resting reading's share of the noise, below which repeats may have drifted apart
    hopeless: float = 0.6  # a share of what re-tuning leaves, above which after the best pair a third cause is no use
    # a mean squared residual of a pressure that passes for healthy: no two causes are behind that
    slight: float = SLIGHT
    scant: float = 0.02  # a share of what the design leaves, below which a third cause would not be accepted
