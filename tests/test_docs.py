"""What the pages say is so: links lead somewhere, examples load, verbs and files that they name are there."""

from __future__ import annotations

import re
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from app.cli import cli
from hal.profile import load_profile

HOUSE = Path(__file__).resolve().parent.parent
PAGES = sorted([*HOUSE.glob("*.md"), *HOUSE.glob("docs/**/*.md"), HOUSE / "logs" / "README.md"])
IDS = [page.relative_to(HOUSE).as_posix() for page in PAGES]
README = HOUSE / "README.md"


def text_of(page: Path) -> str:
    return page.read_text(encoding="utf-8")


def commands_in(page: Path) -> set[tuple[str, ...]]:
    """Words of every `lostmotion ...` on the page: inline code and blocks alike."""
    text = re.sub(r"`([^`\n]+)\n([^`\n]+)`", r"`\1 \2`", text_of(page))
    found = re.findall(r"(?:^ {4}|`|^\$ )(?:\.venv/bin/)?lostmotion ([^`\n#]+)", text, re.MULTILINE)
    return {tuple(part.split()) for line in found for part in line.split(" && lostmotion ")}


@pytest.mark.parametrize("page", PAGES, ids=IDS)
def test_links_and_pictures_lead_somewhere(page) -> None:
    targets = re.findall(r"\]\(([^)\s]+)\)", text_of(page))
    local = [target.partition("#")[0] for target in targets if "://" not in target and not target.startswith("#")]
    assert [target for target in local if not (page.parent / target).exists()] == []


def anchors_of(page: Path) -> set[str]:
    """What a `#...` may name: the headings outside of code, as forges spell them."""
    text = re.sub(r"^```.*?^```", "", text_of(page), flags=re.DOTALL | re.MULTILINE)
    headings = re.findall(r"^#{1,6} (.+)$", text, re.MULTILINE)
    words = [re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).strip().lower() for heading in headings]
    return {re.sub(r"[^\w\- ]", "", heading).replace(" ", "-") for heading in words}


@pytest.mark.parametrize("page", PAGES, ids=IDS)
def test_links_to_sections_name_a_heading(page) -> None:
    links = re.findall(r"\]\(([^)\s#:]*(?:\.md)?)#([^)\s]+)\)", text_of(page))
    named = [(page.parent / file if file else page, anchor) for file, anchor in links]
    lost = [f"{p.name}#{anchor}" for p, anchor in named if p.suffix == ".md" and anchor not in anchors_of(p)]
    assert lost == []


def test_a_heading_is_spelled_as_in_a_link(tmp_path) -> None:
    page = tmp_path / "a.md"
    page.write_text("## A stranger's plant, `x_y` & [more](b.md)\n\n```\n# no heading\n```\n", encoding="utf-8")
    assert anchors_of(page) == {"a-strangers-plant-x_y--more"}


@pytest.mark.parametrize("page", PAGES, ids=IDS)
def test_verbs_and_options_that_it_names_exist(page) -> None:
    wrong = []
    root = click.Context(cli)
    for words in commands_in(page):
        verb = words[0]
        if not re.fullmatch(r"[a-z][a-z-]*", verb):
            continue  # an option of the program itself, or a placeholder
        command = cli.get_command(root, verb)
        known = {"--help", "-h"} | {name for p in command.params for name in p.opts} if command else set()
        used = {word.partition("=")[0] for word in words if word.startswith("--")}
        if command is None or used - known:
            wrong.append(" ".join(words))
    assert wrong == []


def test_pictures_are_small() -> None:
    large = [path.name for path in (HOUSE / "docs" / "pictures").iterdir() if path.stat().st_size > 300_000]
    assert large == []


def test_the_index_lists_every_page() -> None:
    index = text_of(HOUSE / "docs" / "index.md")
    pages = [page.relative_to(HOUSE / "docs").as_posix() for page in HOUSE.glob("docs/**/*.md")]
    others = [page for page in pages if page != "index.md" and not page.startswith(("blind/", "strangers/"))]
    assert [page for page in others if f"({page})" not in index] == []


def test_the_page_of_strangers_lists_every_plant() -> None:
    listed = text_of(HOUSE / "docs" / "strangers.md")
    plants = [page.name for page in (HOUSE / "docs" / "strangers").iterdir()]
    assert [name for name in plants if f"(strangers/{name}" not in listed] == []


def test_the_blind_page_lists_every_published_check() -> None:
    listed = text_of(HOUSE / "docs" / "blind.md")
    pages = [page.relative_to(HOUSE / "docs").as_posix() for page in HOUSE.glob("docs/blind/*.md")]
    assert pages
    assert [page for page in pages if f"({page})" not in listed] == []


def test_the_profile_in_the_readme_is_a_working_bench(tmp_path) -> None:
    blocks = re.findall(r"```toml\n(.*?)```", text_of(README), re.DOTALL)
    (mine,) = (block for block in blocks if "[devices." in block)
    file = tmp_path / "mine.toml"
    file.write_text(mine, encoding="utf-8")
    assert load_profile(str(file)).name == "mine"
    checked = CliRunner().invoke(cli, ["check", "--profile", str(file)], catch_exceptions=False)
    assert "BAD" not in checked.output
    assert checked.exit_code == 0


def test_the_architecture_page_names_files_that_are_there() -> None:
    named = set(
        re.findall(
            r"`((?:app|twin|control|logs|hal|sim_device)/[\w/]+\.py)`", text_of(HOUSE / "docs" / "architecture.md")
        )
    )
    assert named
    assert [name for name in named if not (HOUSE / name).is_file()] == []
