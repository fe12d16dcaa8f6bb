"""How good `brake` is on draws that nobody has looked at: `python bench/held_out.py [FIRST_SEED SEEDS]`.

Runs for some minutes (14 seeds of 14 scenarios, and two seeds of them as they are named), writes
docs/held-out.json and the table of docs/controllers.md, which a test compares.
"""

from __future__ import annotations

import sys
from pathlib import Path

from app.held_out import run, write


def main() -> None:
    first, seeds = (int(word) for word in sys.argv[1:3]) if len(sys.argv) > 2 else (8000, 14)
    drawn = run(range(first, first + seeds), drawn=True, processes=2)
    write(Path("docs"), drawn, run(range(2), drawn=False, processes=2))


if __name__ == "__main__":
    main()
