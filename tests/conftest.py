"""Before anything imports numpy: one library thread, as `app/__main__.py` has it, because tests run side by side."""

from __future__ import annotations

import os

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")
