"""A model beside a run: what it predicts, how far the bench is off, and the drift alarm, in the record and the view."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from click import echo

if TYPE_CHECKING:
    from app.job import Job
    from control.loop import Sink
    from twin.model.plant import Plant


#: What to do about a model in percent beside a bench in another unit, or the other way round.
_OF_THE_BENCH = "identify a model from a record of this bench"


def plant_beside(path: Path, command_unit: str) -> Plant:
    """The model of the file in the units of a bench.

    Raises: `BadInput` for a model that cannot be read or does not fit the bench's units.
    """
    from control.design import load_design
    from hal.errors import BadInput
    from twin.model.insert import plant_of
    from twin.model.model_units import in_units_of

    try:
        return plant_of(in_units_of(load_design(path), command_unit, "in", _OF_THE_BENCH))
    except BadInput as error:
        raise BadInput(f"--twin {path}: {str(error).removeprefix(f'{path}: ')}") from error


def with_twin(job: Job, path: Path, command_unit: str) -> Job:
    """The job with the model of the file beside it; its record names the model and the alarm's promise.

    Raises: `BadInput` as `plant_beside` does.
    """
    from app.job import Beside
    from twin.live.alarm import AlarmRules
    from twin.live.monitor import Monitor
    from twin.live.sink import COLUMNS, TwinSink

    plant = plant_beside(path, command_unit)
    rules = AlarmRules()
    monitor = Monitor(plant, command_unit, job.plan.duration_s, rules)
    monitor.warm_up()

    def around(sinks: Sequence[Sink]) -> Sink:
        return TwinSink(monitor, sinks, lambda text: echo(f"warning: {text}", err=True))

    said = {
        "model": path.name,
        "valve": str(plant),
        "alarm_shift_percent_of_travel": 100.0 * rules.shift,
        "alarm_within_s": rules.within_s,
        "false_alarm_s": rules.false_alarm_s,
    }
    return replace(job, about={**job.about, "twin": said}, beside=Beside(COLUMNS, around))
