"""Forty frozen blind trials that must not get worse: `python bench/blind_ci.py` (exit 1 when they have).

Half-length sequences with their repeat, both families, always the same seals. The counts that are held to stand in
`bench/blind_ci.toml`; `--write` measures them anew, which belongs into a commit that says why. The seals are not those
of any published check.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import tomllib
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

from app.blind.pool import run_all
from app.blind.score import score
from app.blind.table import rows
from app.blind.trial import orders

SEED, TRIALS = 4040, 40
LIMITS = Path(__file__).with_suffix(".toml")
SLACK = 2  # trials that may turn without a reason: machines round differently
MORE = 1  # likewise, of what may not become more


def counts(scores: dict[str, Any]) -> dict[str, dict[str, int]]:
    """What is held to: hits that may not become fewer, and faults that may not become more."""
    group = scores["all"]
    least = {kind: entry["hits"] for kind, entry in group["by_kind"].items()}
    least |= {"right": group["right"]["hits"], "leading": group["leading"]["hits"]}
    most = {"false_cause_on_none": group["false_cause_on_none"]["hits"], "broken": len(scores["broken"])}
    return {"least": least, "most": most}


def worse(found: dict[str, dict[str, int]], limits: dict[str, dict[str, int]]) -> list[str]:
    """A sentence for everything that is beyond its limit."""
    low = [f"{k}: {found['least'][k]}, at least {v}" for k, v in limits["least"].items() if found["least"][k] < v]
    high = [f"{k}: {found['most'][k]}, at most {v}" for k, v in limits["most"].items() if found["most"][k] > v]
    return low + high


def written(found: dict[str, dict[str, int]]) -> str:
    """The limits file: what was measured, with the slack for hits."""
    lines = [
        f"# python bench/blind_ci.py --write: {TRIALS} trials of seed {SEED}; measured less {SLACK}, and plus {MORE}.",
        "[least]",
    ]
    lines += [f"{name} = {max(value - SLACK, 0)}" for name, value in found["least"].items()]
    lines += ["", "[most]", *(f"{name} = {value + MORE}" for name, value in found["most"].items()), ""]
    return "\n".join(lines)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true", help="write the limits instead of holding to them")
    parser.add_argument("--trials", type=int, default=TRIALS, help="fewer, to see it run; only with --write or to look")
    parser.add_argument("--processes", type=int, default=2)
    asked = parser.parse_args()
    lines = []
    with tempfile.TemporaryDirectory() as folder:
        todo = [replace(o, share=0.5) for o in orders(asked.trials, SEED, "both", Path(folder))]
        with closing(run_all(todo, Path(folder), asked.processes)) as results:
            for line in results:
                lines.append(line)
                mark = "broken" if "error" in line else "right" if line["mark"]["right"] else "wrong"
                print(f"{len(lines):3}/{asked.trials} trial {line['trial']}: {mark}", flush=True)
    scores = score(lines)
    for what, figure, interval in rows(scores["all"]):
        print(f"{what:52}{figure:20}{interval}".rstrip())
    found = counts(scores)
    if asked.write:
        LIMITS.write_text(written(found), encoding="utf-8")
        return 0
    if asked.trials != TRIALS:
        return 0
    if not LIMITS.is_file():
        sys.exit(f"{LIMITS}: there are no limits yet; measure them with --write")
    bad = worse(found, tomllib.loads(LIMITS.read_text(encoding="utf-8")))
    for sentence in bad:
        print(f"WORSE: {sentence}")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
