"""Believes causes whose design numbers had moved further than anybody believes, if they can do without that.

What only imitates a cause needs bent numbers for it. But a form that is not quite true moves them as well, once the gap
is a hundred times the noise and what the form leaves of it a few times: then the numbers have hardly anything to do
with what the causes explain.
"""

from __future__ import annotations

from dataclasses import replace

from twin.choose.decide import Decision
from twin.choose.lean import as_designed
from twin.model.effect import Scales
from twin.search.needless import LEAVES


def unbent(decision: Decision, scales: Scales) -> Decision:
    """The decision, explained if what seemed to imitate leaves next to nothing with the numbers as designed."""
    if not decision.imitates or decision.rest_of(as_designed(decision, scales)) >= LEAVES:
        return decision
    return replace(decision, explained=True, gap=True, imitates=False)
