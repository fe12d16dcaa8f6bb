"""The signature of an unexplained residual, as an operator reads it."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from twin.report.words import name, number, percent

Facts = Mapping[str, object]


def signature_rows(found: Facts) -> list[tuple[str, str]]:
    """Label and text of what `twin.judge.unexplained.residual_signature` found; other keys are left out."""
    rows = ((label, text(found)) for label, text in _ROWS.items())
    return [(label, said) for label, said in rows if said]


def _where(found: Facts) -> str:
    rms = found.get("rms_over_noise")
    return f"the {found['signal']}, {number(rms)} times its noise (RMS)" if "signal" in found else ""


def _depends(found: Facts) -> str:
    shares = _of(found, "depends_on")
    largest = sorted(shares.items(), key=lambda item: -_real(item[1]))
    return ", ".join(f"{name(what)} {percent(_real(share))}" for what, share in largest)


def _repeats(found: Facts) -> str:
    share = found.get("repeats")
    return "" if share is None else f"{percent(_real(share))} of its square: the rest was there once"


def _frequency(found: Facts) -> str:
    if "strongest_frequency_hz" not in found:
        return ""
    return f"{number(found['strongest_frequency_hz'])} Hz, with {percent(_real(found['share_at_it']))} of the power"


def _looks_like(found: Facts) -> str:
    rival = dict(_of(found, "looks_like"))
    what = rival.pop("what", "")
    sizes = ", ".join(f"{name(key)} {_sized(value)}" for key, value in rival.items())
    return f"{what} ({sizes})" if sizes else str(what)


def _differs(found: Facts) -> str:
    loud = _of(found, "does_not_repeat")
    if not loud:
        return ""
    between, resting = number(loud.get("between_repeats")), number(loud.get("at_rest"))
    return f"the {loud.get('signal')}: {between} {loud.get('unit')} between repeats, {resting} at rest"


def _swings(found: Facts) -> str:
    swing = _of(found, "swings")
    if not swing:
        return ""
    size = f"{number(swing.get('amplitude'))} {swing.get('unit')} at {number(swing.get('frequency_hz'))} Hz as sampled"
    return f"the {swing.get('signal')}, by {size}: {percent(_real(swing.get('share')))} of what the design misses"


def _of(found: Facts, key: str) -> Facts:
    value = found.get(key)
    return value if isinstance(value, Mapping) else {}


def _real(value: object) -> float:
    return float(value) if isinstance(value, (int, float)) else float("nan")


def _sized(value: object) -> str:
    if not isinstance(value, Mapping):
        return number(value)
    unit = value.get("unit", "")
    return f"{number(value.get('value'))}{'' if unit in ('', '1') else f' {unit}'}"


_ROWS: Mapping[str, Callable[[Facts], str]] = {
    "largest in": _where,
    "goes with": _depends,
    "came back with the same commands": _repeats,
    "strongest frequency": _frequency,
    "looks as if": _looks_like,
    "does not repeat": _differs,
    "swings by itself": _swings,
}
