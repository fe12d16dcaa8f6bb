"""What is written down before the first trial: the commitments of all valves, and the code that will judge them.

Nothing of it can be chosen afterwards: a folder is only gone on with by the same code, with the same seed.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from app.blind.trial import Order
from hal.errors import BadInput

FILE = "protocol.json"
_HOUSE = Path(__file__).resolve().parents[2]
#: What a result depends on, recording and marking included; how results are counted and shown may change.
_SOURCES = (
    *(f"app/blind/{name}.py" for name in ("designs", "excite", "mark", "sizes", "strength", "trial")),
    *(f"{package}/**/*.py" for package in ("control", "hal", "sim_device", "twin")),
    "app/job.py",
    "app/session.py",
    "logs/*.py",
    "app/blind/baselines/*.toml",
    "hal/profiles/*.toml",
)


def code_digest() -> str:
    """SHA-256 over all source files that a trial runs through: it changes with any threshold in them."""
    total = hashlib.sha256()
    for path in sorted({path for pattern in _SOURCES for path in _HOUSE.glob(pattern)}):
        total.update(f"{path.relative_to(_HOUSE).as_posix()}\0".encode())
        total.update(path.read_bytes())
    return total.hexdigest()


def begin(out: Path, todo: Sequence[Order], seed: int, family: str) -> dict[str, Any]:
    """Writes protocol.json, or checks that the one that is there is of the same check and the same code.

    More trials of the same seed may be asked for later; their commitments are added before they are run.
    Raises: `BadInput` when the folder belongs to another check, or the code has changed since.
    """
    from logs.start import git_state, package_version
    from sim_device.sealed import draw
    from twin.diagnose import Settings

    path = out / FILE
    before = _read(path)
    digest = code_digest()
    for key, value in (("seed", seed), ("family", family), ("code", digest)):
        if before and before.get(key) != value:
            raise BadInput(
                f"{path}: this check was begun with {key} = {before.get(key)!r}, now it is {value!r}; "
                "a blind check is one code and one seed, so name a new folder"
            )
    known = dict(before.get("commitments", {}))
    seals = {order.seal: known.get(order.seal) or draw(order.seal, (order.family,)).commitment for order in todo}
    content = {
        "seed": seed,
        "family": family,
        "code": digest,
        "git": git_state(),
        "version": package_version(),
        "settings": asdict(Settings()),
        **before,
        "commitments": known | seals,
    }
    out.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
    return content


def check(content: dict[str, Any], lines: Sequence[dict[str, Any]]) -> None:
    """Whether every result belongs to the valve that was committed to before the first trial.

    Raises: `BadInput` naming the trial.
    """
    for line in lines:
        if "commitment" in line and content["commitments"].get(line["seal"]) != line["commitment"]:
            raise BadInput(
                f"{FILE}: trial {line['trial']} ({line['seal']}) has another commitment than was written down"
            )


def _read(path: Path) -> dict[str, Any]:
    if not path.is_file():
        return {}
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise BadInput(f"{path}: this is no protocol ({error}); name a new folder") from error
    if not isinstance(content, dict):
        raise BadInput(f"{path}: this is no protocol; name a new folder")
    return content
