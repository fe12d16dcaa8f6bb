"""`lostmotion`, and `python -m app`: runs the command line after making sure that the packages are ours.

Nothing but what Python has loaded anyway is imported before Ctrl-C is taken care of: an import that is cut short would
say so with a traceback.
"""

from __future__ import annotations

import os
import signal
import sys

TYPE_CHECKING = False  # typing itself takes longer to import than all else here
if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType

# Our matrices are a few columns wide: library threads only wake each other up (a diagnosis takes 2.5 times as long).
_LIBRARY_THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")
_INTERRUPTED = 130


def _leave(_signal: int, _frame: FrameType | None) -> None:
    """Ends the program at once; for as long as there is nothing to close."""
    os.write(2, b"lostmotion: interrupted\n")
    os._exit(_INTERRUPTED)


def _on_interrupt(handler: Callable[[int, FrameType | None], None]) -> None:
    """Lets Ctrl-C do that, unless somebody has said that it shall do nothing (nohup, a shell's background)."""
    if signal.getsignal(signal.SIGINT) in (signal.default_int_handler, _leave):
        signal.signal(signal.SIGINT, handler)


def _check_not_shadowed() -> None:
    """python-control installs a top-level `control` too; a clash must be loud, not strange."""
    from importlib.util import find_spec
    from pathlib import Path

    house = Path(__file__).resolve().parent.parent
    for name in ("hal", "control", "logs", "sim_device", "twin"):
        spec = find_spec(name)
        origin = Path(spec.origin).resolve() if spec and spec.origin else None
        if origin is None or house not in origin.parents:
            sys.exit(
                f"lostmotion: package '{name}' is taken by {origin}; install lostmotion in an environment of its own"
            )


def main() -> None:
    """Runs `sys.argv` and exits with the roof's code. The thread limits must stand before numpy is imported."""
    _on_interrupt(_leave)
    for name in _LIBRARY_THREADS:
        os.environ.setdefault(name, "1")
    _check_not_shadowed()
    from app.cli import run

    try:
        _on_interrupt(signal.default_int_handler)
        code = run(sys.argv[1:])
    except KeyboardInterrupt:  # before `run` listens, or when it has just stopped to
        code = _INTERRUPTED
    _on_interrupt(_leave)
    sys.exit(code)


if __name__ == "__main__":
    main()
