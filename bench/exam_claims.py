"""Every probability that was said on the strangers' sets, so that sets can be added up: docs/strangers.json.

One entry for each set, under its seed: for each probability that was said, how many causes were named with it, and how
many of these were true.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from app.blind.calibration import Claim
from hal.errors import BadInput

#: By seed: (probability, true, named) for each probability, the highest first.
Claims = Mapping[str, Sequence[tuple[float, int, int]]]

_DIGITS = 4


def seed_of(folder: Path) -> str:
    """The digits at the end of a folder's name, under which its claims are kept. Raises: `BadInput` without any."""
    found = re.search(r"(\d+)$", folder.resolve().name)
    if found is None:
        raise BadInput(f"{folder}: --claims keeps them under the seed that ends the folder's name; call it set_SEED")
    return found[1]


def counted(claims: Sequence[Claim]) -> list[tuple[float, int, int]]:
    """The claims of a set by what was said."""
    said = [(round(p, _DIGITS), right) for p, right in claims]
    steps = sorted({p for p, _ in said}, reverse=True)
    return [(p, sum(right for q, right in said if q == p), sum(q == p for q, _ in said)) for p in steps]


def claims_of(sets: Claims, seeds: Sequence[str]) -> list[Claim]:
    """All claims of these sets; of a set that is not kept there are none."""
    steps = [step for seed in seeds for step in sets.get(seed, ())]
    return [(p, k < true) for p, true, named in steps for k in range(named)]


def keep(path: Path, seed: str, claims: Sequence[Claim]) -> None:
    """Adds a set to the file, or replaces it there: a line for each, the largest seed last."""
    sets = read(path) | {seed: counted(claims)} if path.exists() else {seed: counted(claims)}
    lines = (f'  "{name}": {json.dumps(sets[name])}' for name in sorted(sets))
    path.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")


def read(path: Path) -> dict[str, list[tuple[float, int, int]]]:
    """What `keep` wrote."""
    found = json.loads(path.read_text(encoding="utf-8"))
    return {seed: [(float(p), int(true), int(named)) for p, true, named in steps] for seed, steps in found.items()}
