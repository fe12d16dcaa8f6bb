"""The answer of a diagnosis: where, which, how far, how sure, what next; and its JSON.

Everything here is data. The keys that scripts rely on are those of the interfaces page; keys beyond them
(`statement`, `sentences_in`, `gap_by_condition`, `effects_tested`, `residual_signature`, `structure`, `noise`,
`closed_loop`, `complete`, `incomplete_because`, `interrupted`, a cause's `form`, a candidate's `rejected`) are free.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Literal

from logs.recording import DataNote
from logs.spoken import HOUSE, Spoken
from twin.strict import json_ready

Verdict = Literal["no_gap", "parameter", "effect", "effects", "unexplained"]
Interval = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Share:
    """A fraction of the reducible squared error with its 95 % interval; below 0 where something masks."""

    value: float
    ci95: Interval


@dataclass(frozen=True, slots=True)
class Estimate:
    """A number with its 95 % interval and its unit."""

    value: float
    ci95: Interval
    unit: str = ""


@dataclass(frozen=True, slots=True)
class Bin:
    """The share of the half-open bin `low <= quantity < high`."""

    low: float
    high: float
    share: Share


@dataclass(frozen=True, slots=True)
class Cause:
    """A named cause. `heldout_gap_without`: the held-out RMS [% of travel] when this cause is left out. `form`: which
    form of its effect the updated model has; empty for a design number."""

    name: str
    stage: str
    probability: float
    heldout_gap_without: float | None = None
    parameters: Mapping[str, Estimate] = field(default_factory=dict)
    form: str = ""


@dataclass(frozen=True, slots=True)
class Ranked:
    """One line of the ranking: a candidate, its probability, its held-out RMS [% of travel].

    `rejected`: it was taken for a cause, or was next to one, and unseen data spoke against it.
    """

    name: str
    probability: float
    heldout_gap: float | None
    rejected: bool = False


@dataclass(frozen=True, slots=True)
class Where:
    """Shares of the reducible squared error, group by group; each group sums to 1, or is None when unknowable."""

    stage: Mapping[str, Share] | None = None
    attributed: Mapping[str, Share] | None = None
    direction: Mapping[str, Share] | None = None
    regime: Mapping[str, Share] | None = None
    position: tuple[Bin, ...] | None = None
    pressure: tuple[Bin, ...] | None = None
    time: tuple[Bin, ...] | None = None
    frequency: tuple[Bin, ...] | None = None


@dataclass(frozen=True, slots=True)
class Gap:
    """RMS of position on held-out data, in `unit`; `reducible_closed` is None when there was nothing to close."""

    before: float
    retuned: float
    after: float
    noise_floor: float
    reducible_closed: Share | None
    unit: str = "percent_of_travel"


@dataclass(frozen=True, slots=True)
class NextExperiment:
    """Why another experiment, and the file `sweep` runs; `file` is None when no experiment could help."""

    why: str
    file: str | None = None


@dataclass(frozen=True, slots=True)
class EffectTest:
    """What this record could show of one cause: `detection_limit` [`unit`] is a value of `parameter` in the `form` that
    shows first, of a design number how far it is off; None if untestable."""

    name: str
    testable: bool
    reason: str = ""
    parameter: str = ""
    detection_limit: float | None = None
    unit: str = ""
    form: str = ""


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """The verdict on a set of recordings. `statement` is the sentence an operator reads first.

    `incomplete`: why this is no whole answer, empty if it is one; the verdict may then be nothing but a place holder.
    `spoken`: the units that sizes have in its sentences; its numbers have those of the records.
    """

    verdict: Verdict
    statement: str
    causes: tuple[Cause, ...]
    ranking: tuple[Ranked, ...]
    gap: Gap
    where: Where = Where()
    confusable: tuple[tuple[str, ...], ...] = ()
    next_experiment: NextExperiment | None = None
    data_quality: tuple[DataNote, ...] = ()
    effects_tested: tuple[EffectTest, ...] = ()
    residual_signature: Mapping[str, object] = field(default_factory=dict)
    structure: tuple[str, ...] = ()
    noise: Mapping[str, object] = field(default_factory=dict)
    closed_loop: Mapping[str, object] = field(default_factory=dict)
    version: str = ""
    incomplete: str = ""
    spoken: Spoken = HOUSE
    gap_by_condition: Gap | None = None

    def to_json(self) -> dict[str, object]:
        """Plain dicts, lists, numbers and None, ready for a strict JSON writer (no NaN, no infinity)."""
        document = {
            "verdict": self.verdict,
            "statement": self.statement,
            "causes": [_cause(cause) for cause in sorted(self.causes, key=lambda c: -c.probability)],
            "confusable": self.confusable,
            "ranking": self.ranking,
            "where": _where(self.where),
            "gap": _gap(self.gap),
            "gap_by_condition": self.gap_by_condition and _gap(self.gap_by_condition),
            "next_experiment": self.next_experiment,
            "data_quality": self.data_quality,
            "effects_tested": {test.name: _unnamed(test) for test in self.effects_tested},
            "residual_signature": self.residual_signature,
            "structure": self.structure,
            "noise": self.noise,
            "closed_loop": self.closed_loop,
            "sentences_in": self.spoken,
            "version": self.version,
            "complete": not self.incomplete,
            "incomplete_because": self.incomplete or None,
            "interrupted": bool(self.incomplete),
        }
        plain = json_ready(document)
        assert isinstance(plain, dict)
        return plain


def write_diagnosis(diagnosis: Diagnosis, path: Path) -> None:
    """Writes diagnosis.json (UTF-8, two-space indent, strict JSON)."""
    text = json.dumps(diagnosis.to_json(), indent=2, ensure_ascii=False, allow_nan=False)
    path.write_text(text + "\n", encoding="utf-8")


def _cause(cause: Cause) -> dict[str, object]:
    return {
        "name": cause.name,
        "stage": cause.stage,
        "form": cause.form or None,
        "probability": cause.probability,
        "heldout_gap_without": cause.heldout_gap_without,
        "parameters": cause.parameters,
    }


def _where(where: Where) -> dict[str, object]:
    groups = {key: _group(getattr(where, key)) for key in ("stage", "attributed", "direction", "regime")}
    return groups | {key: _bins(getattr(where, key)) for key in ("position", "pressure", "time", "frequency")}


def _group(group: Mapping[str, Share] | None) -> dict[str, object] | None:
    if group is None:
        return None
    shares: dict[str, object] = {name: share.value for name, share in group.items()}
    return shares | {"ci95": {name: share.ci95 for name, share in group.items()}}


def _bins(bins: tuple[Bin, ...] | None) -> list[dict[str, object]] | None:
    if bins is None:
        return None
    return [{"from": b.low, "to": b.high, "share": b.share.value, "ci95": b.share.ci95} for b in bins]


def _gap(gap: Gap) -> dict[str, object]:
    closed = gap.reducible_closed
    return {
        "unit": gap.unit,
        "before": gap.before,
        "retuned": gap.retuned,
        "after": gap.after,
        "noise_floor": gap.noise_floor,
        "reducible_closed": None if closed is None else closed.value,
        "ci95": None if closed is None else closed.ci95,
    }


def _unnamed(test: EffectTest) -> dict[str, object]:
    """Its fields without the name, which is its key."""
    return {one.name: getattr(test, one.name) for one in fields(test) if one.name != "name"}
