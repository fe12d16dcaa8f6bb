"""The report's words: numbers, shares, and what is left of an unexplained gap."""

from __future__ import annotations

from twin.report.signature import signature_rows
from twin.report.words import number, percent


def test_what_is_left_is_said_in_words() -> None:
    jump = {"what": "the zero of the reading jumps", "step": {"value": 0.01, "unit": "in"}, "share": {"value": 0.5}}
    found = {
        "signal": "position",
        "rms_over_noise": 6.1234,
        "depends_on": {"position": 0.2, "time": 0.97},
        "repeats": 0.68,
        "strongest_frequency_hz": 0.0054,
        "share_at_it": 0.526,
        "looks_like": jump,
        "does_not_repeat": {"signal": "position", "between_repeats": 0.02, "at_rest": 0.001, "unit": "in"},
        "swings": {"frequency_hz": 1.5, "amplitude": 0.004, "share": 0.8, "signal": "position", "unit": "in"},
    }
    assert signature_rows(found) == [
        ("largest in", "the position, 6.12 times its noise (RMS)"),
        ("goes with", "time 97 %, position 20 %"),
        ("came back with the same commands", "68 % of its square: the rest was there once"),
        ("strongest frequency", "0.00540 Hz, with 53 % of the power"),
        ("looks as if", "the zero of the reading jumps (step 0.0100 in, share 0.500)"),
        ("does not repeat", "the position: 0.0200 in between repeats, 0.00100 at rest"),
        ("swings by itself", "the position, by 0.00400 in at 1.50 Hz as sampled: 80 % of what the design misses"),
    ]
    assert signature_rows({"repeats": None}) == []


def test_words() -> None:
    assert percent(0.9999, 1) == "> 99.9 %"
    assert percent(0.0001) == "< 1 %"
    assert percent(1.0) == "100 %"
    assert percent(float("nan")) == "-"
    assert number(0.0008) == "0.000800"
    assert number(1.23e-7) == "1.23e-07"
    assert number(None) == "-"
    assert number(12345.6) == "12346"
