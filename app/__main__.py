"""`lostmotion`, and `python -m app`: runs the command line after making sure that the packages are ours."""

from __future__ import annotations

import sys
from importlib.util import find_spec
from pathlib import Path

_HOUSE = Path(__file__).resolve().parent.parent


def _check_not_shadowed() -> None:
    """python-control installs a top-level `control` too; a clash must be loud, not strange."""
    for name in ("hal", "control", "logs", "sim_device", "twin"):
        spec = find_spec(name)
        origin = Path(spec.origin).resolve() if spec and spec.origin else None
        if origin is None or _HOUSE not in origin.parents:
            sys.exit(
                f"lostmotion: package '{name}' is taken by {origin}; install lostmotion in an environment of its own"
            )


def main() -> None:
    _check_not_shadowed()
    from app.cli import run

    sys.exit(run(sys.argv[1:]))


if __name__ == "__main__":
    main()
