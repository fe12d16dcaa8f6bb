"""A thinned look at large records: the search over hypotheses sees this, the final numbers are computed on all rows.

Two ways, taken as far as needed. Rows are left out where they come faster than the lags of a valve need; a row keeps
its reading as it is (no average: its noise stays the noise that was measured) and gets the mean command since the row
before it, and the rows around a jump of the command stay, so that no edge moves. A record that lasts too long is seen
through windows spread evenly over it, each where the stem covers most of its range. What the stem remembers at the
start of one is what came before: minutes of that are simulated, in rows and steps far apart, and not compared.
"""

from __future__ import annotations

from dataclasses import replace
from math import ceil, floor

import numpy as np
import numpy.typing as npt

from logs.recording import DataNote, Recording
from twin.choose.stages import StageResult, driven_again
from twin.events.refresh import Freshness
from twin.fit.beginning import beginning
from twin.fit.case import Case, Span, fine_step_s
from twin.fit.hidden_steps import hidden_step_s
from twin.fit.trial import Trial, make_trial
from twin.model.held_band import accepted_rows
from twin.model.place import Place
from twin.model.timegrid import make_grid
from twin.noise.model import NoiseModel, SignalNoise
from twin.record.rows import kept_rows, thinned

#: Above this many rows, or seconds, a look is taken; it has about so many.
MOST_ROWS = 20_000
LOOK_ROWS = 12_000
#: Windows that have fewer than these are not looked through, if the whole can be seen in coarse steps and has no more
#: than so many rows: with 30,000 of one a second that takes 20 to 44 s instead of 10 to 17.
FEW_ROWS, NOT_MANY_ROWS = 6_000, 24_000
MOST_S = 2_400.0
#: A record up to so long is looked at whole, in coarse steps [s], where the noise (share of travel) hides what they
#: miss; up to so many rows none is left out that comes no faster than these steps.
COARSE_S, COARSE_STEP_S, COARSE_NOISE = 6_000.0, 0.1, 4e-4
COARSE_ROWS = 60_000
#: Whatever the seconds, so few steps of simulation make no large record: a slow machine is read every ten seconds.
MOST_STEPS = 60_000
LOOK_S = 1_200.0
#: Windows are about so long [s], and each is the liveliest of so many in its part of the record.
_WINDOW_S = 300.0
_CHOICES = 8
#: So much of what came before a window [s] leads to it, one row in so many seconds, in steps so many times as long; but
#: the last so many lags of it as the window itself.
_HISTORY_S, _HISTORY_ROW_S, _HISTORY_STEPS = 600.0, 1.0, 5.0
_LEAD_LAGS = 20.0


def look_at(case: Case) -> tuple[Case, list[DataNote]]:
    """The case to search on: `case` itself when it is small, else a look at it that knows its whole."""
    whole = sum(r.n for r in case.recordings)
    spans = _spans(case, _short(case))
    rows = sum(s.stop - s.start for s in spans)
    # windows of a record whose rows come slowly have few of them, and a loop in them may go but one way
    few = rows < min(FEW_ROWS, whole) and whole <= NOT_MANY_ROWS
    hidden_s = hidden_step_s(case, MOST_STEPS) if few else 0.0
    if hidden_s > 0.0:
        spans, rows = _spans(case, True), whole
    if rows == whole <= MOST_ROWS and hidden_s == 0.0:
        return case, []
    coarse_s = hidden_s or (COARSE_STEP_S if rows == whole and _hides_steps(case) else 0.0)
    share = _share(case, rows, coarse_s)
    trials = tuple(_trial(case, span, share, coarse_s) for span in spans)
    stride = rows / max(sum(map(_looked_at, trials)), 1)
    look = replace(
        case,
        recordings=tuple(t.recording for t in trials),
        trials=trials,
        noise=_thinned_noise(case.noise, stride),
        whole=case,
        spans=spans,
    )
    return look, [_note(case, trials, spans, rows, whole, coarse_s)]


def _share(case: Case, rows: int, coarse_s: float) -> float:
    """Share of the rows that the search sees: in coarse steps, all that do not come faster than these."""
    least = min(1.0, LOOK_ROWS / rows)
    if coarse_s <= 0.0 or rows > COARSE_ROWS:
        return least
    step_rows = rows * coarse_s / sum(r.duration_s for r in case.recordings)
    return max(least, 1.0 / max(1, floor(step_rows)))


def on_everything(case: Case, result: StageResult) -> StageResult:
    """What was decided on a look, with the trials of the whole case."""
    if result.case is case:
        return result
    return replace(result, case=case, trials=driven_again(case, result))


def _note(
    case: Case, trials: tuple[Trial, ...], spans: tuple[Span, ...], rows: int, whole: int, coarse_s: float
) -> DataNote:
    seen = sum(map(_looked_at, trials))
    where = f"on {seen} rows all over it"
    if rows < whole:
        where = f"on {seen} rows in {len(spans)} windows spread over it"
    elif seen == whole:
        where = f"on all of them in steps of {coarse_s:.2g} s"
    return DataNote(
        f"a large record: {whole} rows, {sum(r.duration_s for r in case.recordings):.4g} s",
        f"causes are searched {where}; the gap is computed on all rows",
        whole - seen,
    )


def _short(case: Case) -> bool:
    """Whether a case is looked at whole whatever its noise may hide."""
    total_s = sum(r.duration_s for r in case.recordings)
    steps = sum(t.grid.n_fine for t in case.trials)
    return total_s <= (COARSE_S if _hides_steps(case) else MOST_S) or steps <= MOST_STEPS


def _spans(case: Case, all_of_it: bool) -> tuple[Span, ...]:
    if all_of_it:
        return tuple(Span(k, 0, r.n, 0) for k, r in enumerate(case.recordings))
    total_s = sum(r.duration_s for r in case.recordings)
    spans: list[Span] = []
    for k, recording in enumerate(case.recordings):
        budget_s = max(LOOK_S * recording.duration_s / total_s, 100.0 * case.base.design.tau_s)
        spans += _windows(k, recording, budget_s)
    return tuple(spans)


def _hides_steps(case: Case) -> bool:
    """Whether the noise hides the error of coarse steps, 0.02 % of travel RMS of full strokes."""
    return case.sigma_y > COARSE_NOISE * case.travel


def _windows(record: int, recording: Recording, budget_s: float) -> list[Span]:
    """Windows of together `budget_s`, one in each of as many equal parts of the record."""
    if recording.duration_s <= budget_s:
        return [Span(record, 0, recording.n, 0)]
    count = max(1, round(budget_s / _WINDOW_S))
    length_s, part_s = budget_s / count, recording.duration_s / count
    return [_liveliest(record, recording, k * part_s, part_s, length_s) for k in range(count)]


def _liveliest(record: int, recording: Recording, begin_s: float, part_s: float, length_s: float) -> Span:
    origin = recording.time_s[0]
    best, most = Span(record, 0, recording.n, 0), -1.0
    for offset_s in np.linspace(0.0, max(part_s - length_s, 0.0), _CHOICES):
        first = origin + begin_s + float(offset_s)
        edges = np.searchsorted(recording.time_s, (first - _HISTORY_S, first, first + length_s))
        history, start, stop = (int(i) for i in edges)
        values = recording.position[start:stop]
        values = values[np.isfinite(values)]
        if values.size < 20:
            continue
        low, high = np.percentile(values, (2.0, 98.0))
        if float(high - low) > most:
            best, most = Span(record, start, stop, history), float(high - low)
    return best


def _trial(case: Case, span: Span, share: float, coarse_s: float) -> Trial:
    """The trial of one span, thinned to a `share` of its rows, in steps of `coarse_s` or more, and what led to it."""
    whole = case.trials[span.record]
    recording = whole.recording.slice(span.history, span.stop)
    led = span.start - span.history
    led_s = float(recording.time_s[led] - recording.time_s[0])
    dense = int(np.searchsorted(recording.time_s, recording.time_s[0] + led_s - _LEAD_LAGS * case.base.design.tau_s))
    accepted = np.zeros(0, dtype=np.int64)
    if case.sigma_p is not None and share < 1.0 and span.start == 0:  # what is held where a window begins nobody knows
        accepted = accepted_rows(whole.recording, case.sigma_p)
    kept = _kept(recording.slice(dense, recording.n), share, accepted)
    rows = np.concatenate([_far_apart(recording, dense), dense + kept])
    thin = thinned(recording, rows)
    false, vague = (marks[span.history : span.stop][rows] for marks in (whole.false, whole.vague))
    step_s = max(fine_step_s(case.base.design, thin), coarse_s)
    steps_s = np.where(rows[1:] <= dense, _HISTORY_STEPS * step_s, step_s)
    begun = beginning(case.base, thin, make_grid(thin.time_s, steps_s, thin.command), case.coarse)
    trial = make_trial(thin, steps_s, false, begun, _fresh_of(whole, span, rows), vague)
    seen = thin.time_s - thin.time_s[0] >= led_s
    return replace(
        trial, place=_later(whole, span.history), led_s=led_s, use_y=trial.use_y & seen, use_p=trial.use_p & seen
    )


def _kept(recording: Recording, share: float, accepted: npt.NDArray[np.int64]) -> npt.NDArray[np.intp]:
    """The rows that stay of a `share` of a recording, and those in which its converter has `accepted` a command."""
    within = accepted[(accepted >= 0) & (accepted < recording.n)]
    return kept_rows(recording.command, max(2, ceil(share * recording.n)), within)


def _far_apart(recording: Recording, stop: int) -> npt.NDArray[np.intp]:
    """Of the first `stop` rows of a recording as many as it has long periods, and both sides of every jump."""
    if stop < 2:
        return np.arange(stop)
    before = recording.slice(0, stop)
    return kept_rows(before.command, max(2, ceil(before.duration_s / _HISTORY_ROW_S)))


def _looked_at(trial: Trial) -> int:
    """How many rows of a trial are no history."""
    return int(np.count_nonzero(trial.recording.time_s - trial.recording.time_s[0] >= trial.led_s))


def _later(whole: Trial, first: int) -> Place:
    """The place of a part that begins with row `first`: the clock of its recording goes on from part to part."""
    time_s, place = whole.recording.time_s, whole.place
    within_s, whole_s = float(time_s[first] - time_s[0]), whole.recording.duration_s
    since_s = place.since_s + within_s
    return replace(place, since_s=since_s, span_s=place.span_s or whole_s, within_s=within_s, whole_s=whole_s)


def _fresh_of(whole: Trial, span: Span, rows: npt.NDArray[np.intp]) -> Freshness | None:
    """How fresh the readings of the kept rows are."""
    return None if whole.fresh is None else whole.fresh.kept(rows + span.history, whole.recording.time_s)


def _thinned_noise(noise: NoiseModel, stride: float) -> NoiseModel:
    pressure = None if noise.pressure is None else _fewer(noise.pressure, stride)
    return replace(noise, position=_fewer(noise.position, stride), pressure=pressure)


def _fewer(noise: SignalNoise, stride: float) -> SignalNoise:
    """The noise of every `stride`-th reading: as loud, with a shorter memory in rows."""
    if stride < 1.5:
        return noise
    memory = max(1.0, noise.correlation_samples / stride)
    return replace(
        noise, correlation_samples=memory, period_s=noise.period_s * stride, ar=(), innovation_sigma=noise.sigma
    )
