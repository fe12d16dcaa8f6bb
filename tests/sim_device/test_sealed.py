from __future__ import annotations

import hashlib
import json
from collections import Counter
from pathlib import Path

import pytest

from hal.errors import BadInput
from sim_device.physics.catalog import imperfections, make_physics, parameters
from sim_device.physics.offline import record
from sim_device.sealed import SHARES, commit, draw, reveal, salt_of, unseal, write
from tests.sim_device.physics.excitation import lively


def sealed_run(folder: Path, seed: int | str, diagnosed: bool = True) -> Path:
    write(folder, draw(seed))
    if diagnosed:
        (folder / "diagnosis.json").write_text("{}")
    return folder


def test_a_seed_always_draws_the_same_valve() -> None:
    one, two = draw(5), draw("5")
    assert one.commitment == two.commitment
    time_s, command = lively(20)
    assert record(one.physics, time_s, command)[1].tolist() == record(two.physics, time_s, command)[1].tolist()


def test_the_commitment_is_the_salted_hash_of_the_label() -> None:
    label = reveal(12)
    expected = hashlib.sha256(f"{salt_of(12)}|{label.canonical()}".encode()).hexdigest()
    assert draw(12).commitment == expected
    assert json.loads(label.canonical())["kind"] == label.kind
    assert commit(label, salt_of(13)) != expected


def test_kinds_come_in_their_shares_and_sizes_in_all_grades() -> None:
    labels = [reveal(seed) for seed in range(3000)]
    kinds = Counter(label.kind for label in labels)
    for kind, share in SHARES.items():
        assert kinds[kind] / 3000 == pytest.approx(share, abs=0.03)
    grades = Counter(cause.grade for label in labels for cause in label.causes)
    assert min(grades.values()) > 0.3 * sum(grades.values())
    assert {label.family for label in labels} == {"thesis", "reference"}
    assert len({cause.name for label in labels for cause in label.causes}) > 40


def test_a_label_says_as_many_causes_as_its_kind() -> None:
    for seed in range(500):
        label = reveal(seed)
        names = [cause.name for cause in label.causes]
        assert len(set(names)) == len(names) == {"none": 0, "effects": 2}.get(label.kind, 1)
        assert all(name.startswith("parameter:") for name in names) == (label.kind in ("parameter", "none"))


def test_every_label_that_can_be_drawn_makes_a_valve() -> None:
    for seed in range(800):
        label = reveal(seed)
        make_physics(label.family, 1, effects={cause.key: cause.size for cause in label.causes})


@pytest.mark.parametrize("family", ["thesis", "reference"])
def test_the_ends_of_every_size_make_a_valve(family: str) -> None:
    for item in (*imperfections(family), *parameters(family)):
        for form in item.forms:
            for sign in (1.0, -1.0) if item.signed else (1.0,):
                size = item.within(sign * 10.0**0.12 * item.size(2, form))
                make_physics(family, 1, effects={f"{item.name}/{form}" if form != "default" else item.name: size})


def test_families_can_be_chosen() -> None:
    assert {reveal(seed, ("reference",)).family for seed in range(50)} == {"reference"}
    with pytest.raises(BadInput, match="choose one or more of thesis, reference"):
        reveal(1, ("piano",))


def test_the_file_says_nothing_of_the_label(tmp_path: Path) -> None:
    text = write(tmp_path, draw(3)).read_text()
    assert set(json.loads(text)) == {"format", "commitment", "families"}


def test_it_is_revealed_after_the_diagnosis(tmp_path: Path) -> None:
    assert unseal(sealed_run(tmp_path, 3), 3) == reveal(3)


def test_it_stays_sealed_before_the_diagnosis(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="stays sealed; diagnose it first"):
        unseal(sealed_run(tmp_path, 3, diagnosed=False), 3)


def test_another_seed_does_not_fit(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="does not belong to seed 4"):
        unseal(sealed_run(tmp_path, 3), 4)


def test_a_changed_commitment_does_not_fit(tmp_path: Path) -> None:
    sealed_run(tmp_path, 3)
    path = tmp_path / "sealed.json"
    content = json.loads(path.read_text())
    content["commitment"] = "0" * 64
    path.write_text(json.dumps(content))
    with pytest.raises(BadInput, match="does not belong to seed 3"):
        unseal(tmp_path, 3)


@pytest.mark.parametrize(("text", "words"), [(None, "no such file"), ("[]", "not a commitment file"), ("{", "not a")])
def test_a_missing_or_broken_commitment_is_named(tmp_path: Path, text: str | None, words: str) -> None:
    (tmp_path / "diagnosis.json").write_text("{}")
    if text is not None:
        (tmp_path / "sealed.json").write_text(text)
    with pytest.raises(BadInput, match=words):
        unseal(tmp_path, 3)
