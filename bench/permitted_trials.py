"""What an oracle misses of the held-out trials: `python bench/permitted_trials.py [FIRST_SEED SEEDS]`.

Runs for some minutes (50 seeds of 14 scenarios), writes docs/permitted-trials.json and the second table of
docs/controllers.md, which a test compares.
"""

from __future__ import annotations

import sys
from pathlib import Path

from app.permitted_trials import run, write


def main() -> None:
    first, seeds = (int(word) for word in sys.argv[1:3]) if len(sys.argv) > 2 else (13000, 50)
    write(Path("docs"), run(range(first, first + seeds)))


if __name__ == "__main__":
    main()
