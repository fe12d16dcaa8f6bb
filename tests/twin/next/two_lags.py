"""A dispute for tests: a short record of a valve with a dead time, which a sensor lag explains almost as well."""

from __future__ import annotations

from functools import cache
from types import SimpleNamespace

import numpy as np

from control.design import DesignModel
from control.experiment import Experiment
from control.experiment_catalog import make_experiment
from logs.recording import Recording
from twin.fit.case import Case, make_case
from twin.fit.channel import Channel, chain_channel
from twin.fit.fitting import Fit, fit, starts_of
from twin.fit.space import ACCUSED_SPREAD, Cause, make_space
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant
from twin.next.rivals import Dispute, rival_of
from twin.replay.simulate import Start, simulate_recording
from twin.search.score import inflation

SIGMA = 0.0006
TRUTH = Plant(DesignModel(), (Inserted("dead_time", effect("dead_time").forms[0], (0.1,)),))


def recorded(plant: Plant, experiment: Experiment, seed: int = 0) -> Recording:
    """What a valve that is `plant` reads in the experiment, with noise and without a pressure transmitter."""
    schedule = experiment.commands()
    command = np.concatenate([schedule.command[:1], schedule.command[:-1]])
    blank = Recording("made", schedule.time_s, command, np.zeros(command.size))
    _, y = simulate_recording(plant, blank, start=Start(command[0], 0.0, 0.0))
    noise = SIGMA * np.random.default_rng(seed).standard_normal(y.size)
    return Recording("made", schedule.time_s, command, y + noise)


def cause(name: str, form: str | None = None) -> Cause:
    found = effect(name)
    return Cause(name, found, found.form(form) if form else found.forms[0])


def fitted(case: Case, channel: Channel, one: Cause) -> Fit:
    space = make_space(case.base, (one,), channel.numbers, case.scales)
    return fit(channel, space, starts_of(space))


@cache
def record() -> Recording:
    """A coarse staircase of four minutes: few steps, so that a delay and a lag look alike."""
    return recorded(TRUTH, make_experiment("staircase", {"step": 3.0, "dwell_s": 12.0}))


@cache
def result(*names: str) -> SimpleNamespace:
    """What a diagnosis of the record knows: the first name accepted, all names fitted."""
    case = make_case([record()], DesignModel())
    channel = chain_channel(case.trials, case.sigma_y)
    fits = tuple(fitted(case, channel, cause(name)) for name in names)
    space = make_space(case.base, (), channel.numbers, case.scales, ACCUSED_SPREAD)
    retuned = fit(channel, space, starts_of(space))
    phi = inflation(fits[0].residuals, channel.use)
    found = {"channel": channel, "fits": fits, "phi": phi, "retuned": retuned, "none": retuned}
    findings = SimpleNamespace(**found, score=lambda f: -f.mse)
    accepted = SimpleNamespace(findings=findings, accepted=fits[0], names=fits[0].names, explained=True, slips=None)
    return SimpleNamespace(case=case, decisions=(accepted,))


def dispute(*names: str) -> Dispute:
    found = result(*names)
    decision = found.decisions[0]
    first, *others = (rival_of(found, decision, f, f.names[0]) for f in decision.findings.fits)
    return Dispute(names[0], "chain", first, tuple(others), (), decision.findings.phi, max(first.fit.mse, 1.0))
