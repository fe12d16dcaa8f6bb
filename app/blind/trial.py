"""One blind trial: a sealed valve is recorded over Modbus, diagnosed, and only then unsealed and marked.

The diagnosis sees what came over the wire and the model of the healthy machine, nothing else. A second record, of the
valve switched on anew and in closed loop, is kept from it and shows what the updated model is worth on other data.
"""

from __future__ import annotations

import json
import shutil
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from control.design import DesignModel
    from control.plan import Plan
    from hal.profile import Profile
    from logs.recording import Recording
    from twin.diagnose import Outcome

CONTROLLER = "if_then_pi"


@dataclass(frozen=True, slots=True)
class Order:
    """What to do: trial `number`, the valve of `seal` out of one `family`, in a new `folder`.

    `share` is the length of the test sequence, 1 being the whole one, gone through `repeats` times.
    """

    number: int
    seal: str
    family: str
    folder: Path
    keep: bool = False
    share: float = 1.0
    repeats: int = 2

    @property
    def plan(self) -> Plan:
        """The test sequence of this trial."""
        from app.blind.excite import open_loop

        return open_loop(self.number, self.repeats, self.share)


def orders(count: int, seed: int, family: str, out: Path, keep: bool = False) -> list[Order]:
    """The trials of a check: the same seed gives the same valves. `family` "both" takes turns."""
    families = ("thesis", "reference") if family == "both" else (family,)
    return [
        Order(number, f"blind-{seed}-{number}", families[number % len(families)], out / f"trial-{number:04d}", keep)
        for number in range(count)
    ]


def run_trial(order: Order) -> dict[str, Any]:
    """Does it all and returns the result as plain values. A folder left by a trial that was interrupted is redone.

    Raises: `BenchFault` when the wire failed, `BadInput` when the commitment does not hold.
    """
    from app.blind.excite import closed_loop

    if order.folder.exists():
        shutil.rmtree(order.folder)
    order.folder.mkdir(parents=True)
    began = time.monotonic()
    record = _recorded(order, order.plan, "record")
    fresh = _recorded(order, closed_loop(order.number), "closed-loop", closed=True)
    recorded = time.monotonic()
    outcome = _diagnosed(order, record)
    diagnosed = time.monotonic()
    line = _unsealed(order)
    line["closed_loop"] = _closure(order.family, outcome, fresh)
    line["rows"] = record.n
    line["seconds"] = {"record": round(recorded - began, 2), "diagnose": round(diagnosed - recorded, 2)}
    if not order.keep:
        for name in ("record", "closed-loop"):
            shutil.rmtree(order.folder / name)
    return line


def _recorded(order: Order, plan: Plan, name: str, closed: bool = False) -> Recording:
    """The sealed valve, switched on anew, goes through a plan over Modbus; the record is read back from disk."""
    from app.job import Job, perform
    from app.session import open_bench
    from control.controller import make_controller
    from control.drive import ControllerDrive, OpenLoopDrive
    from logs.load import load_recording

    with open_bench(profile=_profile(), sealed=order.seal, families=(order.family,)) as session:
        if closed:
            made = make_controller(CONTROLLER, _baseline(order.family))
            job = Job("run", plan, lambda begun: ControllerDrive(made, plan.period_s, begun), closed_loop=True)
        else:
            job = Job("sweep", plan, lambda _: OpenLoopDrive())
        folder = perform(session, job, out=order.folder / name, live=False, title=f"trial {order.number}").folder
    if not closed:  # the commitment stays when the samples go
        shutil.copy(folder / "sealed.json", order.folder / "sealed.json")
    return load_recording(folder)


def _profile() -> Profile:
    """The virtual bench with its alarms on the position out of the way: a faulty sensor is what is looked for."""
    from hal.profile import load_profile

    found = load_profile("virtual")
    return found.model_copy(
        update={"limits": found.limits.model_copy(update={"position_min_in": None, "position_max_in": None})}
    )


def _diagnosed(order: Order, record: Recording) -> Outcome:
    """The diagnosis, on disk before anything is unsealed."""
    from app.blind.designs import margin
    from control.design import save_design
    from twin.diagnose import Settings, diagnose
    from twin.diagnosis import write_diagnosis
    from twin.model.insert import inserted_from
    from twin.search.search_rules import SearchRules

    design = _baseline(order.family)
    settings = Settings(search=SearchRules(threads=1), margin=margin(order.family))
    outcome = diagnose([record], design, inserted_from(design), settings)
    write_diagnosis(outcome.diagnosis, order.folder / "diagnosis.json")
    save_design(
        outcome.model, order.folder / "model.toml", outcome.diagnosis.statement, effect_units=outcome.effect_units
    )
    return outcome


def _unsealed(order: Order) -> dict[str, Any]:
    """Breaks the seal, which checks the commitment, and marks what the file says."""
    from app.blind.excite import commands
    from app.blind.mark import mark
    from app.blind.sizes import check_sizes
    from app.blind.strength import stratum, strength
    from sim_device.sealed import unseal

    label = unseal(order.folder, order.seal)
    said = json.loads((order.folder / "diagnosis.json").read_text(encoding="utf-8"))
    commitment = json.loads((order.folder / "sealed.json").read_text(encoding="utf-8"))["commitment"]
    force = strength(label, *commands(order.plan))
    return {
        "trial": order.number,
        "seal": order.seal,
        "commitment": commitment,
        "label": asdict(label),
        "strength": asdict(force),
        "ratio": force.ratio,
        "weakest": force.weakest,
        "stratum": stratum(force.ratio),
        **{key: said[key] for key in ("verdict", "causes", "confusable", "gap")},
        "ranking": said["ranking"][:10],
        "where_stage": said["where"]["stage"],
        "mark": asdict(mark(label, said)),
        "sizes": [asdict(check) for check in check_sizes(label, said, _baseline(order.family))],
    }


def _closure(family: str, outcome: Outcome, fresh: Recording) -> dict[str, float | None]:
    """RMS [% of travel] of the position on the closed-loop record: design, updated model, floor; and what was closed.

    False readings, which no model can foretell, are left out of both.
    """
    import numpy as np

    from twin.events.scan import scan_events
    from twin.noise.model import estimate_noise
    from twin.replay.simulate import simulate_recording
    from twin.where.closure import closure, rms

    noise = estimate_noise([fresh])
    good = ~scan_events(fresh, noise).false_position
    percent = 100.0 / outcome.model.travel
    before, after = (
        percent * np.where(good, fresh.position - simulate_recording(model, fresh)[1], np.nan)
        for model in (_baseline(family), outcome.model)
    )
    floor = outcome.diagnosis.gap.noise_floor
    share = closure(before, after, floor, noise.position.correlation_samples)
    return {
        "before": rms(before),
        "after": rms(after),
        "floor": floor,
        "closed": None if share is None else share.value,
    }


def _baseline(family: str) -> DesignModel:
    from app.blind.designs import baseline

    return baseline(family)
