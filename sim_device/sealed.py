"""Sealed valves: a seed decides what is wrong with a valve, and only a salted hash of that is written down.

The commitment is the SHA-256 of a salt and the label's canonical JSON, so nobody can change the label afterwards.
It is a commitment and not a safe: who has this code and guesses the seed can recompute the label, so a person who
wants to be blind uses a seed (any text) that somebody else keeps.
"""

from __future__ import annotations

import hashlib
import json
import random
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from hal.errors import BadInput
from sim_device.physics.catalog import imperfections, make_physics, parameters

if TYPE_CHECKING:
    from sim_device.physics.imperfection import Imperfection
    from sim_device.valve import ValvePhysics

FAMILIES = ("thesis", "reference")
SHARES = {"none": 0.25, "effect": 0.40, "parameter": 0.10, "effects": 0.15, "outsider": 0.10}
GRADES = ("small", "medium", "large")
FILE_NAME = "sealed.json"
FORMAT = 1
_SPREAD = 0.12  # sizes are spread by this many decades either way about their grade


@dataclass(frozen=True, slots=True)
class Cause:
    """One thing that is wrong: its name, the stage it is in, the law it follows, its size and grade."""

    name: str
    stage: str
    form: str
    size: float
    unit: str
    grade: str

    @property
    def key(self) -> str:
        """The name with its form, as `make_physics` takes it."""
        return self.name if self.form == "default" else f"{self.name}/{self.form}"


@dataclass(frozen=True, slots=True)
class Label:
    """The truth about a sealed valve. `kind` is none, effect, parameter, effects (two) or outsider."""

    kind: str
    family: str
    physics_seed: int
    causes: tuple[Cause, ...]

    def canonical(self) -> str:
        """The one way to write this label as JSON: sorted keys, no spaces."""
        content = {"format": FORMAT} | asdict(self)
        return json.dumps(content, sort_keys=True, separators=(",", ":"))


@dataclass(frozen=True, slots=True)
class Sealed:
    """A valve with something (or nothing) wrong with it. `family` says which machine it is, which is no secret."""

    physics: ValvePhysics
    commitment: str
    family: str
    families: tuple[str, ...] = FAMILIES


def draw(seed: int | str, families: Sequence[str] = FAMILIES) -> Sealed:
    """Makes the sealed valve of `seed` out of one of `families`; the same seed gives the same valve and commitment.

    Raises: `BadInput` when `families` is empty or names an unknown one.
    """
    label = reveal(seed, families)
    effects = {cause.key: cause.size for cause in label.causes}
    physics = make_physics(label.family, label.physics_seed, effects=effects)
    return Sealed(physics, commit(label, salt_of(seed)), label.family, tuple(families))


def reveal(seed: int | str, families: Sequence[str] = FAMILIES) -> Label:
    """The label that `draw` gives to this seed. For `unseal` and for scoring, after the diagnosis.

    Raises: `BadInput` when `families` is empty or names an unknown one.
    """
    unknown = [name for name in families if name not in FAMILIES]
    if unknown or not families:
        raise BadInput(f"families {list(families)}: choose one or more of {', '.join(FAMILIES)}")
    dice = random.Random(_digest("valve", seed))
    family = sorted(families)[int(dice.random() * len(families))]
    kind = _pick(dice, list(SHARES), list(SHARES.values()))
    return Label(kind, family, int(dice.random() * 2**31), _causes(dice, kind, family))


def _causes(dice: random.Random, kind: str, family: str) -> tuple[Cause, ...]:
    if kind == "none":
        return ()
    pool: Sequence[Imperfection] = parameters(family)
    if kind != "parameter":
        pool = [item for item in imperfections(family) if item.outsider == (kind == "outsider")]
    chosen = []
    for _ in range(2 if kind == "effects" else 1):
        item = pool[int(dice.random() * len(pool))]
        chosen.append(_cause(dice, item))
        pool = [other for other in pool if other is not item]
    return tuple(chosen)


def _cause(dice: random.Random, item: Imperfection) -> Cause:
    form = item.forms[int(dice.random() * len(item.forms))]
    grade = int(dice.random() * len(GRADES))
    spread = 10.0 ** (_SPREAD * (2.0 * dice.random() - 1.0)) if item.spread else 1.0
    sign = -1.0 if dice.random() < 0.5 and item.signed else 1.0
    size = item.within(sign * item.size(grade, form) * spread)
    return Cause(item.name, item.stage, form, float(f"{size:.4g}"), item.unit, GRADES[grade])


def _pick(dice: random.Random, names: Sequence[str], shares: Sequence[float]) -> str:
    left = dice.random() * sum(shares)
    for name, share in zip(names, shares, strict=True):
        left -= share
        if left < 0.0:
            return name
    return names[-1]


def _digest(use: str, seed: int | str) -> str:
    return hashlib.sha256(f"lostmotion|{use}|{seed}".encode()).hexdigest()


def salt_of(seed: int | str) -> str:
    """The salt that goes with a seed: 32 hexadecimal digits."""
    return _digest("salt", seed)[:32]


def commit(label: Label, salt: str) -> str:
    """SHA-256 of salt and label, 64 hexadecimal digits."""
    return hashlib.sha256(f"{salt}|{label.canonical()}".encode()).hexdigest()


def write(path: Path, sealed: Sealed) -> Path:
    """Writes the commitment into `path`, or as `sealed.json` if that is a folder: hash and families, no label.

    Raises: `BadInput` when the file cannot be written.
    """
    path = path / FILE_NAME if path.is_dir() else path
    content = {"format": FORMAT, "commitment": sealed.commitment, "families": list(sealed.families)}
    try:
        path.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
    except OSError as error:
        raise BadInput(f"{path}: the commitment cannot be written ({error.strerror})") from error
    return path


def unseal(run: Path, seed: int | str, sealed_file: Path | None = None) -> Label:
    """The label of a sealed run, after its diagnosis is written, checked against the commitment.

    Raises: `BadInput` when there is no diagnosis or no commitment yet, or the seed does not belong to the commitment.
    """
    if not (run / "diagnosis.json").is_file():
        raise BadInput(f"{run}: there is no diagnosis.json, so it stays sealed; diagnose it first")
    path = sealed_file or run / FILE_NAME
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        commitment, families = content["commitment"], tuple(content["families"])
    except FileNotFoundError:
        raise BadInput(f"{path}: no such file; `emulate --sealed SEED --commitment FILE` writes it") from None
    except (ValueError, KeyError, TypeError) as error:
        raise BadInput(f"{path}: this is not a commitment file ({error})") from error
    label = reveal(seed, families)
    if commit(label, salt_of(seed)) != commitment:
        raise BadInput(f"{path}: the commitment does not belong to seed {seed!r}; another seed, or a changed program")
    return label
