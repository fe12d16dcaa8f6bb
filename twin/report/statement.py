"""The sentence that an operator reads first."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace

from logs.spoken import Spoken
from twin.diagnosis import Cause, Diagnosis, Estimate, Gap
from twin.model.catalog import effects

#: Up to so many times the noise an error is "as well as the noise allows".
_LIKE = 1.3
#: Of its interval: below that a size is 0.
_NOTHING = 1e-4
#: The names of numbers of which a curve has many.
_KNOT = re.compile(r"_\d+$")


def statement(diagnosis: Diagnosis) -> str:
    """The verdict in plain words, with the numbers that carry it."""
    g = diagnosis.gap
    if diagnosis.verdict == "no_gap" and g.before > _LIKE * g.noise_floor:
        return (
            f"No gap that a cause accounts for: the design is off by {g.before:.2g} % of travel, more than the "
            f"reading's noise of {g.noise_floor:.2g} %, but in a way that does not come back or is too small to matter."
        )
    if diagnosis.verdict == "no_gap":
        return (
            f"No gap: the design predicts this record to {g.before:.2g} % of travel, "
            f"and the readings' own noise is {g.noise_floor:.2g} %{_at_most(diagnosis)}."
        )
    if diagnosis.verdict == "unexplained":
        if diagnosis.residual_signature.get("signal") == "pressure" and g.before <= _LIKE * g.noise_floor:
            return (
                "Unexplained: it is the pressure reading that is off; the design predicts the stem to "
                f"{g.before:.2g} % of travel (noise {g.noise_floor:.2g} %). None of the known effects accounts for it"
                f"{_looks_like(diagnosis)}."
            )
        return f"Unexplained: {_off(g)}{_looks_like(diagnosis)}."
    names = " and ".join(_named(cause, diagnosis.spoken) for cause in diagnosis.causes)
    closed = g.reducible_closed
    share = f", which closes {_share(closed.value)} of what noise does not account for" if closed else ""
    off = "A design number is off" if len(diagnosis.causes) == 1 else "Design numbers are off"
    what = off if diagnosis.verdict == "parameter" else "The design leaves something out"
    if closed is None and diagnosis.causes and all(c.stage == "ep" for c in diagnosis.causes):
        return (
            f"{what}: {names}. The measured pressure shows it; in this record it hardly moves the stem, whose error is "
            f"{g.before:.2g} % of travel without and {g.after:.2g} % with that (noise {g.noise_floor:.2g} %)."
        )
    them = "it" if len(diagnosis.causes) == 1 else "them"
    return f"{what}: {names}. {_error(g, them)} (noise {g.noise_floor:.2g} %){share}."


def _off(g: Gap) -> str:
    """How far the design is off that nothing explains, and whether its numbers would, re-tuned all together."""
    off = f"the design is off by {g.before:.2g} % of travel"
    if g.retuned <= _LIKE * g.noise_floor < g.before:
        return (
            f"{off} (noise {g.noise_floor:.2g} %); its numbers, re-tuned all together, account for that "
            f"({g.retuned:.2g} % left), but no one of them does, and none of the known effects"
        )
    noise = f"noise {g.noise_floor:.2g} %"
    return f"{off} ({g.retuned:.2g} % re-tuned, {noise}), and none of the known effects accounts for it"


def _share(closed: float) -> str:
    """Of the gap; where less is left than passed for noise, that was not all noise."""
    return "all" if closed >= 1.0 else f"{100.0 * closed:.3g} %"


def _error(g: Gap, them: str) -> str:
    """The error with what was named beside that without; what the readings show by themselves may make it no less."""
    if g.after >= g.before:
        return f"The error on held-out data is {g.after:.2g} % of travel with {them} and {g.before:.2g} % without"
    return f"With {them} the error on held-out data falls from {g.before:.2g} % to {g.after:.2g} % of travel"


def signed(diagnosis: Diagnosis, signature: Mapping[str, object]) -> Diagnosis:
    """The diagnosis with the signature of what it leaves, which the sentence may speak of."""
    diagnosis = replace(diagnosis, residual_signature=signature)
    return replace(diagnosis, statement=statement(diagnosis))


def _looks_like(diagnosis: Diagnosis) -> str:
    """What it looks like, though that is none of the known effects."""
    rival = diagnosis.residual_signature.get("looks_like")
    return f"; it looks as if {rival['what']}" if isinstance(rival, Mapping) else ""


def _at_most(diagnosis: Diagnosis) -> str:
    """That the noise is less than it seems, where the design errs less and the reading was never seen at rest."""
    noise = diagnosis.noise.get("position")
    source = noise.get("source") if isinstance(noise, Mapping) else None
    moving = source in ("straight", "high_frequency")
    seems = moving and diagnosis.gap.before < diagnosis.gap.noise_floor
    return " or less: nothing shows it apart from the motion" if seems else ""


def _named(cause: Cause, spoken: Spoken) -> str:
    """The cause with its sizes; of a curve that many numbers give (`zero_1`, `zero_2`, ...) the largest."""
    curve = [e for name, e in cause.parameters.items() if _KNOT.search(name)]
    told = [f"{name} {_sized(e, spoken)}" for name, e in _sizes(cause).items()]
    told += [f"up to {_sized(max(curve, key=lambda e: abs(e.value)), spoken)}"] if curve else []
    plain = cause.name.removeprefix("parameter:")
    return f"{plain} ({', '.join(told)}; probability {cause.probability:.2f})" if told else plain


def _sized(one: Estimate, spoken: Spoken) -> str:
    """The number with its unit; 0 for what is nothing beside its own doubt."""
    nothing = abs(one.value) < _NOTHING * (one.ci95[1] - one.ci95[0])
    return spoken.text(0.0 if nothing else one.value, one.unit, 3)


def _sizes(cause: Cause) -> Mapping[str, Estimate]:
    """Of a cause's numbers those that say how large it is, and all where none does; none of a curve."""
    effect = effects().get(cause.name)
    form = next((f for f in effect.forms if f.name == cause.form), None) if effect is not None else None
    shapes = {p.name for p in form.parameters if not p.size} if form is not None else set()
    sizes = {name: e for name, e in cause.parameters.items() if name not in shapes} or cause.parameters
    return {name: e for name, e in sizes.items() if not _KNOT.search(name)}
