"""Draws labelled cases: what is wrong with the valve, in which form, and how much it shows. One seed, one case."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bench.stranger.catalog import EFFECT_FORMS, by_cause, related
from bench.stranger.distinct import own_ratio, plain_directions
from bench.stranger.excite import Session, open_loop
from bench.stranger.form import Form
from bench.stranger.noise import POSITION_IN, Noise
from bench.stranger.outsiders import OUTSIDERS
from bench.stranger.parameters import PARAMETER_FORMS
from bench.stranger.record import noise_free_reading
from bench.stranger.valve import HEALTHY, Valve

KINDS = {"none": 0.2, "effect": 0.4, "parameter": 0.1, "effects": 0.2, "outsider": 0.1}
#: How much a cause shows: RMS of what it changes in the noise-free reading, over the sensor's noise.
GRADES = {"small": (1.5, 3.0), "medium": (3.0, 10.0), "large": (10.0, 40.0)}
_FORMS = {"effect": EFFECT_FORMS, "effects": EFFECT_FORMS, "parameter": PARAMETER_FORMS, "outsider": OUTSIDERS}
LEAST_OWN = 0.5  # of the sensor's noise, RMS: below, the record holds nothing that would tell the cause
_TRIES, _HALVINGS, _NEAR = 6, 12, 1.25


class Cause(NamedTuple):
    """One true cause; `ratio` is the RMS that it causes alone over the sensor's noise, `own` what only it can."""

    name: str
    form: str
    stage: str
    grade: str
    size: float
    unit: str
    ratio: float
    own: float


class Case(NamedTuple):
    """A valve with its label, and the session that it is recorded in."""

    seed: list[int]
    kind: str
    causes: tuple[Cause, ...]
    valve: Valve
    session: Session
    noise: Noise

    def label(self) -> dict[str, Any]:
        """The truth, for JSON."""
        return {"kind": self.kind, "rough": self.noise.rough, "causes": [cause._asdict() for cause in self.causes]}


class _Bench(NamedTuple):
    """What sizes are measured against."""

    session: Session
    healthy_in: NDArray[np.float64]
    plain: NDArray[np.float64]
    seed: list[int]

    def changed_in(self, form: Form, size: float, shape: int) -> NDArray[np.float64]:
        """What the form changes in the reading [in], shape (rows,)."""
        valve = form.build(HEALTHY, size, np.random.default_rng(shape))
        return noise_free_reading(valve, self.session, self.seed) - self.healthy_in

    def ratio(self, form: Form, size: float, shape: int) -> float:
        """RMS of what the form changes in the reading, over the sensor's noise."""
        return float(np.sqrt(np.mean(self.changed_in(form, size, shape) ** 2))) / POSITION_IN


def sized(bench: _Bench, form: Form, shape: int, wanted: float) -> tuple[float, float]:
    """The size that shows as much as wanted, and how much it shows; halving the logarithm, within the form's bounds."""
    low, high = form.smallest, form.largest
    if (most := bench.ratio(form, high, shape)) <= wanted:
        return high, most
    size, ratio = high, most
    for _ in range(_HALVINGS):
        size = float(np.sqrt(low * high))
        ratio = bench.ratio(form, size, shape)
        if wanted / 1.05 < ratio < wanted * 1.05:
            break
        low, high = (size, high) if ratio < wanted else (low, size)
    return size, ratio


def _cause(bench: _Bench, forms: list[Form], rng: np.random.Generator) -> tuple[Cause, Form, int] | None:
    """One cause in some form and of some grade, or None when it cannot show in this session."""
    for _ in range(_TRIES):
        form, grade = forms[int(rng.integers(len(forms)))], str(rng.choice(list(GRADES)))
        shape, (low, high) = int(rng.integers(2**31)), GRADES[grade]
        wanted = float(np.exp(rng.uniform(np.log(low), np.log(high))))
        size, ratio = sized(bench, form, shape, wanted)
        own = own_ratio(form, bench.changed_in(form, size, shape), bench.plain)
        if low / _NEAR <= ratio <= high * _NEAR and own >= LEAST_OWN:
            return Cause(form.cause, form.form, form.stage, grade, size, form.unit, ratio, own), form, shape
    return None


def _causes(bench: _Bench, kind: str, rng: np.random.Generator) -> list[tuple[Cause, Form, int]]:
    """The causes of one case: none, one, or two that are not of one family."""
    found: list[tuple[Cause, Form, int]] = []
    if kind == "none":
        return found
    forms = by_cause(_FORMS[kind])
    while len(found) < (2 if kind == "effects" else 1):
        name = str(rng.choice(list(forms)))
        if any(name == other.name or related(name, other.name) for other, _, _ in found):
            continue
        drawn = _cause(bench, forms[name], rng)
        found += [drawn] if drawn is not None else []
    return found


def draw_case(seed: int, index: int, kind: str | None = None, rough: bool = False) -> Case:
    """Case `index` of a seed; `kind` instead of a drawn one."""
    key = [seed, index]
    rng = np.random.default_rng(key)
    drawn = str(rng.choice(list(KINDS), p=list(KINDS.values())))
    session = open_loop(rng)
    bench = _Bench(session, noise_free_reading(HEALTHY, session, key), plain_directions(session, key), key)
    causes = _causes(bench, kind or drawn, rng)
    valve = HEALTHY
    for cause, form, shape in causes:
        valve = form.build(valve, cause.size, np.random.default_rng(shape))
    return Case(key, kind or drawn, tuple(cause for cause, _, _ in causes), valve, session, Noise(rough=rough))
