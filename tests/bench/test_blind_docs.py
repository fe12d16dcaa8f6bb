"""The tables over the published blind checks say what the pages say; a new check gets a page and a row."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from app.interval import wilson
from bench.blind_docs import HOUSE, committed, publish, renewed, with_table
from bench.blind_pages import Check, Figure, Worth, count, figure, published, read
from bench.blind_probabilities import calibration_error, pooled, words
from bench.blind_readme import newest_plant
from bench.blind_summary import MEASURES, POOL
from tests.app.blind.lines import some_lines

CHECKS = published(HOUSE / "docs" / "blind")


@pytest.fixture
def house(tmp_path) -> Path:
    """The documents of this repository, to be spoiled."""
    shutil.copytree(HOUSE / "docs" / "blind", tmp_path / "docs" / "blind")
    for name in ("README.md", "docs/blind.md", "docs/strangers.md", "docs/strangers.json"):
        shutil.copy(HOUSE / name, tmp_path / name)
    return tmp_path


def stale(house: Path) -> list[str]:
    """The documents that are not what the pages say."""
    return [path.name for path, text in renewed(house).items() if path.read_text(encoding="utf-8") != text]


def spoil(path: Path, pattern: str, new: str) -> None:
    text = path.read_text(encoding="utf-8")
    spoiled = re.sub(pattern, new, text, count=1, flags=re.MULTILINE)
    assert spoiled != text
    path.write_text(spoiled, encoding="utf-8")


def finished(folder: Path, seed: int = 99991) -> Path:
    """A finished check of eight trials, of which one broke."""
    folder.mkdir()
    protocol = {"seed": seed, "family": "both", "git": "abc1234", "code": "0" * 64, "commitments": {"a": "", "b": ""}}
    (folder / "protocol.json").write_text(json.dumps(protocol), encoding="utf-8")
    lines = "".join(json.dumps(line) + "\n" for line in some_lines())
    (folder / "trials.jsonl").write_text(lines, encoding="utf-8")
    return folder


def test_summary_and_readme_say_what_the_pages_say() -> None:
    assert stale(HOUSE) == [], "run `.venv/bin/python bench/blind_docs.py`"


def test_a_figure_that_differs_from_its_page_is_stale(house) -> None:
    spoil(house / "docs" / "blind.md", r"\| 67 of 77, 87 % \|", "| 68 of 77, 88 % |")
    assert stale(house) == ["blind.md"]


def test_a_page_that_was_changed_makes_the_tables_stale(house) -> None:
    newest = house / "docs" / "blind" / f"seed-{CHECKS[0].seed}.md"
    spoil(newest, r"first named cause is true \| \d+ of", "first named cause is true | 1 of")
    assert stale(house) == ["blind.md", "README.md"]


def test_a_page_that_is_gone_makes_the_summary_stale(house) -> None:
    (house / "docs" / "blind" / "seed-6174.md").unlink()
    assert stale(house) == ["blind.md"]


def test_a_new_set_of_strangers_cases_makes_the_readme_stale(house) -> None:
    row = "| [newer](strangers/newer-plant.md) | 1 |" + " - |" * 11
    spoil(house / "docs" / "strangers.md", r"(^\| plant \|.*\n.*\n)", rf"\1{row}\n")
    assert stale(house) == ["README.md"]


def test_every_check_has_all_figures_of_the_summary() -> None:
    assert len(CHECKS) >= 20
    assert [c.seed for c in CHECKS for m in MEASURES if m.row not in c.figures["all"]] == []
    assert all(check.trials >= check.figures["all"][MEASURES[0].row].of for check in CHECKS)


def test_families_add_up_to_all() -> None:
    for check in CHECKS:
        families = [figures for name, figures in check.figures.items() if name != "all"]
        for row in (m.row for m in MEASURES if families):  # a check of one family has no columns besides
            assert sum(f[row].hits for f in families if row in f) == check.figures["all"][row].hits, (check.seed, row)
            assert sum(f[row].of for f in families if row in f) == check.figures["all"][row].of, (check.seed, row)


def test_the_newest_code_comes_first() -> None:
    assert [c.seed for c in CHECKS[-2:]] == [31415, 2026]
    assert [c.code for c in CHECKS] == sorted((c.code for c in CHECKS), reverse=True)


def test_the_code_is_of_the_time_of_its_commit() -> None:
    """Of every commit that this copy of the repository has; one with its whole history has them all."""
    times = {check.commit: told for check in CHECKS if (told := _told_by_git(check.commit)) is not None}
    assert times == {check.commit: check.code for check in CHECKS if check.commit in times}
    assert len(times) == len({check.commit for check in CHECKS}) or not _whole_history()


def _told_by_git(commit: str) -> object:
    try:
        return committed(commit)
    except (OSError, subprocess.CalledProcessError):
        return None


def _whole_history() -> bool:
    try:
        asked = ["git", "rev-parse", "--is-shallow-repository"]
        found = subprocess.run(asked, capture_output=True, text=True, check=True, cwd=Path(__file__).parent)
    except (OSError, subprocess.CalledProcessError):
        return False
    return found.stdout.strip() == "false"


def test_counts_that_are_added_up_have_wilsons_interval(house) -> None:
    for page in (house / "docs" / "blind").glob("seed-*.md"):
        if page.name not in {f"seed-{check.seed}.md" for check in CHECKS[:POOL]}:
            page.unlink()
    first = [check.figures["all"]["first named cause is true"] for check in CHECKS[:POOL]]
    hits, of = sum(one.hits for one in first), sum(one.of for one in first)
    low, high = (f"{100 * edge:.0f}" for edge in wilson(hits, of))
    wanted = f"{hits} of {of}, {100 * hits / of:.0f} %"
    new = {path.name: text for path, text in renewed(house).items()}
    assert f"| first cause | {wanted} | {low} to {high} % |" in new["blind.md"]
    assert f"{wanted} ({low} to {high} %)" in new["README.md"]


def test_a_new_check_gets_a_page_and_the_first_row(house, tmp_path) -> None:
    page = publish(finished(tmp_path / "check"), house, when=lambda commit: "2030-01-02 03:04")
    check = read(page)
    assert (check.seed, check.family, check.trials, check.commit) == (99991, "both", 8, "abc1234")
    assert check.code == "2030-01-02 03:04"
    assert check.figures["all"]["false cause although nothing is wrong"].of == 2
    new = {path.name: text for path, text in renewed(house).items()}
    rows = [line for line in new["blind.md"].splitlines() if line.startswith("| [")]
    start = "| [99991](blind/seed-99991.md) | `abc1234` | 8 | 3 of 6, 50 % | 1 of 2, 50 % | 2 of 3, 67 % |"
    assert rows[0].startswith(start)
    assert rows[1].startswith(f"| [{CHECKS[0].seed}]")
    assert "| 1 % or less | **missed**: 1 of 2, 50 % (9 to 91 %) |" in new["README.md"]


def test_a_page_says_what_its_probabilities_were_worth(house, tmp_path) -> None:
    check = read(publish(finished(tmp_path / "check"), house, when=lambda commit: "2030-01-02 03:04"))
    claims = [claim for line in some_lines() if "error" not in line for claim in line["mark"]["claims"]]
    assert sum(piece.true.of for piece in check.worth) == len(claims)
    assert sum(piece.true.hits for piece in check.worth) == sum(right for _, right in claims)


def test_probabilities_of_several_checks_are_added_up() -> None:
    one = Check(
        1, "both", 2, "", "", {}, (Worth("0.9 to 0.95", 0.9, count(8, 10)), Worth("0.5 to 0.7", 0.6, count(1, 2)))
    )
    other = Check(2, "both", 2, "", "", {}, (Worth("0.9 to 0.95", 0.93, count(5, 5)),))
    high, low = pooled([one, other])
    assert (high.span, high.true, low.true) == ("0.9 to 0.95", count(13, 15), count(1, 2))
    assert high.said == pytest.approx((0.9 * 10 + 0.93 * 5) / 15)
    assert "over 17 causes named" in " ".join(words([high, low]))


def test_the_error_of_several_checks_stands_beside_chance() -> None:
    found = calibration_error([Worth("0.9 to 1", 0.95, count(19, 20)), Worth("0.5 to 0.7", 0.6, count(3, 10))])
    assert found is not None
    assert found.value == pytest.approx(10.0 / 30.0 * 0.3)
    assert re.fullmatch(r"30 causes, 0\.0\d\d by chance", found.interval)
    assert calibration_error([Worth("0.9 to 1", 0.95, count(0, 0))]) is None


def test_a_published_check_is_not_written_again(house, tmp_path) -> None:
    with pytest.raises(SystemExit, match="published check is not written again"):
        publish(finished(tmp_path / "check", seed=CHECKS[0].seed), house, when=lambda commit: "2030-01-02 03:04")


def test_a_check_from_outside_of_git_is_not_published(house, tmp_path) -> None:
    folder = finished(tmp_path / "check")
    spoil(folder / "protocol.json", '"abc1234"', "null")
    with pytest.raises(SystemExit, match="no commit"):
        publish(folder, house)


def test_what_a_cell_says() -> None:
    assert figure("42 of 46  91 %") == count(42, 46)
    assert figure("0.996  (n = 49)", "0.9 to 1") == Figure("0.996", 0.996, interval="0.9 to 1")
    assert figure("-") is None


def test_a_page_that_is_no_check_is_named(tmp_path) -> None:
    page = tmp_path / "seed-1.md"
    page.write_text("# Seed 2, family both: 3 trials\n", encoding="utf-8")
    with pytest.raises(ValueError, match=r"seed-1\.md"):
        read(page)


def test_the_newest_plant_is_the_first_row() -> None:
    columns = [measure.column for measure in MEASURES[1:]]
    heads = f"| plant | seed | cases | {' | '.join(columns)} |"
    row = "| [x](strangers/x-plant.md) | 2 | 40 | 7 of 8 | 23 of 28 | 24 of 28 | 3 of 7 | 3 of 4 | 1.12 | - | 0.996 |"
    column = newest_plant(f"# A\n\n| plan |\n|---|\n| 1 |\n\n{heads}\n|---|\n{row}\n")
    assert "(docs/strangers/x-plant.md)" in column.head
    assert column.figures["a cause named on a healthy valve"] == count(1, 8)
    assert column.figures["calibration error"] is None


def test_a_table_is_replaced_and_the_words_around_it_stay() -> None:
    text = "# A\n\n## B\n\nBefore.\n\n| x |\n|---|\n| 1 |\n\nAfter.\n\n## C\n\n| z |\n"
    assert with_table(text, "## B", iter(["| y |", ""])) == text.replace("| x |\n|---|\n| 1 |", "| y |")
    with pytest.raises(ValueError, match="## D"):
        with_table(text, "## D", iter(["| y |"]))
