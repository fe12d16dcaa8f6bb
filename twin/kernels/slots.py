"""What the kernels' flat vectors have in common; where each coefficient stands is in `ep_slots.py` and its two kin.

An effect writes to those slots; a kernel reads there. Plain integers and no enum: compiled kernels use them as
constants. Every slot has a neutral value in the vector that its file makes; three of these are the design model of
interfaces.md. Only ever append: the numbers are in cached kernels.
"""

from __future__ import annotations

FOREVER = 1e30

#: Points of the position grid on which effects may bend the two curves.
GRID = 65
PLAYS = 12  # elements of a distributed play
