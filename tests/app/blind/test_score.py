from __future__ import annotations

import json

import pytest

from app.blind.score import score
from tests.app.blind.lines import label, line, said, some_lines


def test_what_counts_and_what_is_reported_apart() -> None:
    found = score(some_lines())
    everything = found["all"]
    assert found["trials"] == 8 and [b["trial"] for b in found["broken"]] == [7]
    assert (everything["right"]["hits"], everything["right"]["of"]) == (3, 6)  # not the hidden and not the broken one
    assert everything["by_kind"]["none"]["hits"] == 1 and everything["by_kind"]["effect"]["of"] == 2
    assert everything["false_cause_on_none"]["share"] == pytest.approx(0.5)
    assert (everything["false_cause_below_floor"]["hits"], everything["false_cause_below_floor"]["of"]) == (0, 1)
    assert everything["by_stratum"]["below 1"]["detected"]["hits"] == 0
    assert everything["unexplained_found"]["hits"] == 1 and everything["unexplained_wrongly"]["hits"] == 0
    assert (everything["both_of_two"]["hits"], everything["one_of_two"]["hits"]) == (0, 1)


def test_two_causes_of_which_one_cannot_be_seen_are_counted_apart() -> None:
    one, two = (line(k, label("effects", "creep", "dead_time"), said("effect", ("creep", 0.9)), 9.0) for k in (0, 1))
    found = score([one, two | {"weakest": 0.4}])["all"]
    assert (found["both_of_two"]["of"], found["both_visible"]["of"]) == (2, 1)


def test_top_k_asks_for_both_of_two_among_one_more() -> None:
    answer = said("effects", ("creep", 0.9), ("dead_time", 0.8))
    found = score([line(0, label("effects", "creep", "dead_time"), answer, 9.0)])["all"]
    assert found["top"]["1"]["hits"] == 1
    late = said("effects", ("creep", 0.9), ("stiction", 0.8), ("dead_time", 0.7))
    found = score([line(0, label("effects", "creep", "dead_time"), late, 9.0)])["all"]
    assert found["top"]["1"]["hits"] == 0 and found["top"]["2"]["hits"] == 1


def test_the_confusion_matrix_holds_every_visible_single_fault_once() -> None:
    entries = {(e["truth"], e["said"]): e["count"] for e in score(some_lines())["all"]["confusion"]}
    assert entries == {
        ("none", "no_gap"): 1,
        ("none", "creep"): 1,
        ("creep", "creep"): 1,
        ("dead_time", "sensor_lag"): 1,
        ("outsider", "unexplained"): 1,
    }


def test_faults_by_stratum() -> None:
    faults = score(some_lines())["all"]["faults"]
    assert faults["creep"] == {
        "below 1": {"detected": [0, 1], "right": [0, 1]},
        "3 to 10": {"detected": [1, 1], "right": [1, 1]},
    }


def test_closure_is_of_faults_that_show_in_the_closed_loop() -> None:
    closed = score(some_lines())["all"]["closed_loop"]
    assert closed["closed"]["of"] == 3 and closed["closed"]["median"] == pytest.approx(0.9)
    assert closed["made_worse"]["hits"] == 0


def test_families_apart_and_strict_json() -> None:
    lines = [*some_lines(), line(8, label("effect", "creep", family="reference"), said("no_gap"), 3.5)]
    found = score(lines)
    assert found["families"]["reference"]["trials"] == 1 and found["families"]["thesis"]["trials"] == 7
    json.dumps(found, allow_nan=False)


def test_no_trials_at_all() -> None:
    assert score([])["all"]["right"]["share"] is None


def test_intervals_of_what_causes_have_in_common_resample_trials() -> None:
    """A trial that names two causes is one trial: with the same figures its second cause makes nothing surer."""
    single = (("creep", "dead_time"),)

    def lines(twice: bool) -> list[dict[str, object]]:
        found = []
        for k in range(20):
            truth = label("effects", "creep", "dead_time") if twice else label("effect", "creep")
            named = [(name, 0.9) for name in ("creep", "dead_time")[: 1 + twice]]
            sets = (("creep", "dead_time"), ("dead_time", "creep")) if twice else single
            one = line(k, truth, said("effects", *named, confusable=sets if k % 2 else ()), 5.0)
            check = {"error": 0.01 * k, "covered": True}
            found.append(one | {"sizes": [check] * (1 + twice)})
        return found

    both, one = (score(lines(twice))["all"] for twice in (True, False))
    assert both["sets"]["mean_size"] == one["sets"]["mean_size"] == pytest.approx(1.5)
    assert both["sets"]["ci95"] == one["sets"]["ci95"]
    for name in ("error", "error_from_3"):
        assert both["sizes"][name]["of"] == 40
        assert both["sizes"][name]["ci95"] == one["sizes"][name]["ci95"]
