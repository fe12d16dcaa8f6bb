"""P and PI control, and our best, on the bench of chapter 3."""

from __future__ import annotations

import numpy as np

from app.gallery.bench import first_move, response, swing, tails, trial
from app.gallery.figure import Entry, Number


def figure_3_2() -> Entry:
    """P control, both readings."""
    incremental, positional = trial("p_incremental"), trial("p")
    slow = trial("p_incremental", kp=4.0)
    error = np.abs(tails(positional).mean(axis=1))
    return Entry(
        "3-2",
        "Figure 3-2: P control, Kp = 3",
        "Very large steady errors, fluctuations of more than 10 % of travel; changing Kp has little effect.",
        "The thesis does not give the unit of Kp; in psi/in both readings of figure 3-1 are built. The positional one "
        "(a fixed bias plus Kp e) moves the pressure by 1.7 psi over the whole range of errors, less than the "
        "deadband: very large errors, no fluctuation. The incremental one adds Kp e to the measured pressure, so it "
        "integrates, and with the play it hunts: the picture, and the thesis's words. Item 2-8 predicts that "
        "oscillation.",
        (
            Number("fluctuation, incremental", None, swing(tails(incremental)), "% of travel", 0),
            Number("fluctuation with Kp = 4", None, swing(tails(slow)), "% of travel", 0),
            Number("largest steady error, positional", None, float(error.max()), "% of travel", 0),
        ),
        lambda canvas: response(incremental, canvas),
        command="lostmotion run --controller p_incremental --targets 0.14,0.28,0.42",
        notes=("The thesis says only that the fluctuations exceed 10 %; ours are larger.",),
    )


def figure_3_4() -> Entry:
    """PI control."""
    hunting, quiet = trial("pi_antiwindup", ki=8.0), trial("pi_antiwindup")
    away = {"steps": (100.0, 100.0, 40.0), "hold_s": 60.0}
    wound, kept = (trial(name, **away, max_psi=11.0) for name in ("pi", "pi_antiwindup"))  # type: ignore[arg-type]
    late = first_move(wound, 1200) - first_move(kept, 1200)
    return Entry(
        "3-4",
        "Figure 3-4: PI control",
        "Windup at once, so anti-windup was added; large fluctuations and steady errors remained.",
        "The thesis does not give Ki. "
        "With Ki = 8 psi/(in s) the loop lies beyond the border of item 2-8 and hunts. With Ki = 1 it does not hunt, "
        "but half a minute passes in the deadband at every turn, longer than most of the thesis's steps. Without "
        "anti-windup and with only 11 psi of supply, the way back from a target out of reach starts later.",
        (
            Number("fluctuation, Ki = 8", None, swing(tails(hunting)), "% of travel", 0),
            Number("fluctuation, Ki = 1", None, swing(tails(quiet)), "% of travel", 1),
            Number("windup costs", None, late / 10.0, "s", 1),
        ),
        lambda canvas: response(hunting, canvas),
        command="lostmotion run --controller pi_antiwindup --targets 0.14,0.28,0.42",
    )


def figure_beyond() -> Entry:
    """Our best on the same bench."""
    trace = trial("brake")
    tail = tails(trace)
    return Entry(
        "beyond",
        "Beyond: the same steps on the same imperfect bench with `brake`",
        "",
        "A filter through the play learns both edges, the compliance and how sure of them it is, from the measured "
        "pressure and position; the converter's calibration, hysteresis and dead time besides. Moves run at the rate "
        "limit and brake on the opposite edge; then the pressure backs off, and the play holds the stem.",
        (
            Number("largest steady error", 1.3, float(np.abs(tail.mean(axis=1)).max()), "% of travel", 2),
            Number("largest momentary error", None, float(np.abs(tail).max()), "% of travel", 2),
        ),
        lambda canvas: response(trace, canvas),
        command="lostmotion run --controller brake --targets 0.14,0.28,0.42",
    )
