"""Before anything imports numpy: one library thread, as `app/__main__.py` has it, because tests run side by side.

And no property test is held to a clock: the first example loads compiled kernels, and may wait for another process.
"""

from __future__ import annotations

import os

from hypothesis import settings

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

settings.register_profile("no clock", deadline=None)
settings.load_profile("no clock")
