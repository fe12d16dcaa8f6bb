"""Which forms bring another law along: `python bench/switching_forms.py`, pairs of forms in the actuator.

Each friction, stiction, hysteresis and creep is simulated alone, and beside every form of the other effects there at a
ten-millionth of its typical size. What that changes is not the other's size, but the loop that moves the stem.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from control.design import DesignModel
from logs.recording import Recording
from twin.explain import typical_values
from twin.model.catalog import effect, effects
from twin.model.effect import Form
from twin.model.plant import Inserted, Plant
from twin.replay.simulate import simulate_recording

HOSTS = ("distributed_hysteresis", "friction_in_motion", "stiction", "creep")
HARDLY = 1e-7
SHOWN_PERCENT = 0.05
PERIOD_S, ROWS = 0.2, 1500


def excitation() -> Recording:
    """Ramps and steps over the stroke and within it, for five minutes."""
    time_s = np.linspace(0.0, PERIOD_S * (ROWS - 1), ROWS)
    corners = [4.0, 13.0, 13.0, 5.0, 5.0, 11.0, 11.0, 8.0, 8.0, 10.0, 7.5, 9.5, 4.0]
    command = np.interp(time_s, np.linspace(0.0, time_s[-1], len(corners)), corners)
    return Recording("valve", time_s, command, np.zeros(ROWS), np.full(ROWS, 4.0))


def changes_percent(host: tuple[str, str], other: tuple[str, str], record: Recording) -> float:
    """RMS [% of travel] by which `other` (effect, form) of hardly any size moves the stem of a valve with `host`."""
    design, (alone, beside) = DesignModel(), (_inserted(*host, 1.0), _inserted(*other, HARDLY))
    readings = [simulate_recording(Plant(design, some), record)[1] for some in ((alone,), (alone, beside))]
    return float(100.0 * np.sqrt(np.mean(np.square(readings[1] - readings[0]))) / design.travel)


def pairs() -> Iterator[tuple[tuple[str, str], tuple[str, str]]]:
    """Every form of the hosts beside every form with a size of the actuator's other effects."""
    for name in HOSTS:
        for form in _forms(name):
            for other in effects().values():
                if other.name != name and other.stage == "actuator":
                    some = (one for one in _forms(other.name) if any(p.size for p in one.parameters))
                    yield from (((name, form.name), (other.name, one.name)) for one in some)


def _forms(name: str) -> list[Form]:
    return [form for form in effect(name).forms if not form.outside]


def _inserted(name: str, form_name: str, share: float) -> Inserted:
    form = effect(name).form(form_name)
    typical = zip(form.parameters, typical_values(form), strict=True)
    values = (p.neutral + share * (v - p.neutral) if p.size else v for p, v in typical)
    return Inserted(name, form, tuple(values))


def main() -> None:
    """Prints how many pairs change by more than the limit, per host, and the most that any does."""
    record, every = excitation(), list(pairs())
    found = {pair: changes_percent(*pair, record) for pair in every}
    changed = {pair: by for pair, by in found.items() if by > SHOWN_PERCENT}
    print(f"{len(changed)} of {len(every)} pairs of forms change by more than {SHOWN_PERCENT:g} % of travel")
    for name in HOSTS:
        own = {pair: by for pair, by in changed.items() if pair[0][0] == name}
        if own:
            most = max(own, key=lambda pair: own[pair])
            print(f"{name}: {len(own)}, at most {own[most]:.2g} % ({most[0][1]} beside {'/'.join(most[1])})")


if __name__ == "__main__":
    main()
