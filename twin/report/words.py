"""The report's words: names as an engineer says them, numbers with as many digits as they deserve."""

from __future__ import annotations

from math import floor, isfinite, log10

from twin.diagnosis import Diagnosis

VERDICTS = {
    "no_gap": "No gap",
    "parameter": "A design number is off",
    "effect": "One effect is missing",
    "effects": "Several effects are missing",
    "unexplained": "A gap that no candidate explains",
}
_NAMES = {
    "ep": "E/P transducer",
    "actuator_or_sensor": "actuator or sensor",
    "actuator": "actuator",
    "sensor": "position sensor",
    "end_stop": "end stop",
    "parameter:deadband": "design number: deadband a1 - a2",
    "parameter:offset": "design number: offset (a1 + a2) / 2",
    "parameter:compliance": "design number: compliance",
    "parameter:tau": "design number: valve time constant",
    "parameter:rate_limit": "design number: rate limit",
    "parameter:ep_tau": "design number: E/P time constant",
}
#: What a noise floor was measured from.
SOURCES = {
    "repeats": "repeated commands",
    "still": "still stretches",
    "straight": "even stretches",
    "high_frequency": "fast changes",
    "none": "nothing that would show it",
}


def heading(diagnosis: Diagnosis) -> str:
    """The verdict in words; of a diagnosis that did not come to its end, that it has none to be relied on."""
    return f"No whole answer: {diagnosis.incomplete}" if diagnosis.incomplete else VERDICTS[diagnosis.verdict]


def name(key: str) -> str:
    """A key of the vocabulary in words."""
    return _NAMES.get(key, key.replace("_", " "))


def number(value: object, digits: int = 3) -> str:
    """A number with `digits` significant digits and no exponent between 0.0001 and 1e6; words for what is none."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return "-" if value is None else str(value)
    if not isfinite(value):
        return "-"
    if value == 0:
        return "0"
    place = floor(log10(abs(value)))
    if not -5 < place < 6:
        return f"{value:.{digits - 1}e}"
    return f"{value:.{max(0, digits - 1 - place)}f}"


def percent(value: float, digits: int = 0) -> str:
    """A share in percent; what rounds to certainty or to nothing without being it says so."""
    if not isfinite(value):
        return "-"
    least = 0.5 * 10.0 ** (-2 - digits)
    if 1.0 - least <= value < 1.0:
        return f"> {100 - 10.0**-digits:.{digits}f} %"
    if 0.0 < value < least:
        return f"< {10.0**-digits:.{digits}f} %"
    return f"{100 * value:.{digits}f} %".replace("-0 %", "0 %")


def interval(ci95: tuple[float, float], digits: int = 3) -> str:
    """An interval, both ends to the digits of the narrower need."""
    return f"{number(ci95[0], digits)} to {number(ci95[1], digits)}"
