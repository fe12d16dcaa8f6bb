"""`lostmotion`, and `python -m app`: runs the command line after making sure that the packages are ours."""

from __future__ import annotations

import os
import sys
from importlib.util import find_spec
from pathlib import Path

# Our matrices are a few columns wide: library threads only wake each other up (a diagnosis takes 2.5 times as long).
_LIBRARY_THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")
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
    """Runs `sys.argv` and exits with the roof's code. The thread limits must stand before numpy is imported."""
    for name in _LIBRARY_THREADS:
        os.environ.setdefault(name, "1")
    _check_not_shadowed()
    from app.cli import run

    sys.exit(run(sys.argv[1:]))


if __name__ == "__main__":
    main()
