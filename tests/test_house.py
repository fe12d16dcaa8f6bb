"""The rules of the house, held by machine: CONTRIBUTING.md says them in words."""

from __future__ import annotations

import ast
import re
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import pytest

HOUSE = Path(__file__).resolve().parent.parent
PACKAGES = ("app", "control", "hal", "logs", "sim_device", "twin")
LONGEST_FILE, LONGEST_FUNCTION = 250, 40

#: What is longer than it should be. This list may only get shorter.
LONG_FILES = {
    "tests/app/test_diagnose.py",
    "tests/hal/test_bus.py",
    "tests/hal/test_modbus_bench.py",
}
LONG_FUNCTIONS = {
    "app/commands/compare.py:command",
    "app/commands/jog.py:command",
    "app/commands/set.py:command",
    "app/session.py:open_bench",
    "tests/twin/report_example.py:diagnosis",
    "twin/kernels/coupled.py:coupled_steps",
    "twin/kernels/stem.py:stem_pass",
}


def tracked() -> list[Path]:
    """Files that git knows and that are there; in an unpacked archive all files."""
    git = shutil.which("git")
    if git is None or not (HOUSE / ".git").exists():
        return [path for path in HOUSE.rglob("[!.]*") if path.is_file() and ".venv" not in path.parts]
    listed = subprocess.run([git, "ls-files", "-z"], cwd=HOUSE, capture_output=True, text=True, check=True).stdout
    return [path for name in listed.split("\0") if name and (path := HOUSE / name).is_file()]


def sources() -> list[Path]:
    return [path for path in tracked() if path.suffix == ".py"]


def name_of(path: Path) -> str:
    return path.relative_to(HOUSE).as_posix()


def words(path: Path) -> str:
    return path.read_bytes().decode("utf-8", errors="ignore")


@cache
def outline(path: Path) -> tuple[str | None, list[tuple[str, int]]]:
    """Docstring, and names and lengths of the functions. Read once: there are more than a thousand files."""
    tree = ast.parse(words(path))
    lengths = [(node.name, (node.end_lineno or 0) - node.lineno + 1) for node in functions(tree)]
    return ast.get_docstring(tree), lengths


def functions(node: ast.AST) -> Iterator[ast.FunctionDef | ast.AsyncFunctionDef]:
    """All functions in it, one in another, too; expressions hold none and are not looked into."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef):
            yield child
        if not isinstance(child, ast.expr):
            yield from functions(child)


def test_functions_are_found_wherever_they_are() -> None:
    """A match, a handler and a method hold some; without these the rule below would look away."""
    text = """
match x:
    case 1:
        def a(): ...
try:
    pass
except E:
    async def b(): ...
class C:
    def c(self):
        with x:
            def d(): ...
if x: pass
else:
    def e(): ...
"""
    assert [node.name for node in functions(ast.parse(text))] == ["a", "b", "c", "d", "e"]


@pytest.mark.parametrize("package", PACKAGES)
def test_every_top_level_package_is_ours(package) -> None:
    spec = find_spec(package)
    assert spec is not None
    assert spec.origin is not None
    assert Path(spec.origin).resolve() == HOUSE / package / "__init__.py"


def test_every_package_is_packed_typed_and_walled() -> None:
    project = tomllib.loads((HOUSE / "pyproject.toml").read_text(encoding="utf-8"))["tool"]
    found = {path.parent.name for path in HOUSE.glob("*/__init__.py")}
    assert found == set(PACKAGES)
    assert set(project["hatch"]["build"]["targets"]["wheel"]["packages"]) == found
    assert set(project["mypy"]["packages"]) == found | {"bench"}
    assert set(project["importlinter"]["root_packages"]) == found
    layers = project["importlinter"]["contracts"][0]["layers"]
    assert layers == ["app", "twin", "control", "logs", "hal"]


def test_init_files_are_empty() -> None:
    assert [name_of(path) for path in sources() if path.name == "__init__.py" and path.stat().st_size] == []


def test_files_are_short() -> None:
    long = {name_of(path) for path in sources() if len(words(path).splitlines()) > LONGEST_FILE}
    assert long - LONG_FILES == set()


def test_functions_are_short() -> None:
    long = {
        f"{name_of(path)}:{name}"
        for path in sources()
        for name, length in outline(path)[1]
        if length > LONGEST_FUNCTION
    }
    assert long - LONG_FUNCTIONS == set()


def test_every_module_says_what_it_is() -> None:
    silent = [
        name_of(path)
        for path in sources()
        if path.name != "__init__.py" and "tests" not in path.parts and outline(path)[0] is None
    ]
    assert silent == []


# Written in pieces, so that this file does not find itself.
UNWANTED = {
    "an unfinished place": "TO" + "DO|FIX" + "ME",
    "a path of somebody's machine": r"(?<![\w.])/(?:ho" + "me|ro" + "ot|wo" + r"rk|Users)/\w",
    "where packages come from": r"(?<!no-emit-)(?:index" + "-url|find" + "-links|trusted" + "-host)[= ]",
}


@pytest.mark.parametrize("what", UNWANTED)
def test_nothing_unwanted_is_tracked(what) -> None:
    pattern = re.compile(UNWANTED[what])
    text = [path for path in tracked() if b"\0" not in path.read_bytes()[:4096]]
    found = [
        f"{name_of(path)}:{line}"
        for path in text
        for line, content in enumerate(words(path).splitlines(), 1)
        if pattern.search(content)
    ]
    assert found == []


def test_requirements_are_hashed_and_name_no_host() -> None:
    lines = words(HOUSE / "requirements.txt").splitlines()
    pinned = [line for line in lines if line and not line.startswith((" ", "#"))]
    assert pinned
    assert all(re.match(r"[A-Za-z0-9_.-]+==\S+ .*\\$", line) for line in pinned)
    assert not any("://" in line for line in lines)


def test_nothing_large_is_tracked() -> None:
    assert [name_of(path) for path in tracked() if path.stat().st_size > 1_000_000] == []


def test_ci_runs_what_a_developer_runs() -> None:
    assert "make test" in words(HOUSE / ".ci" / "run")
    makefile = words(HOUSE / "Makefile")
    lint = makefile.partition("\nlint:")[2].partition("\n\n")[0]
    for tool in ("ruff check", "ruff format --check", "mypy", "lint-imports"):
        assert f"$(BIN)/{tool}" in lint
    assert re.search(r"^test: .*\blint\b", makefile, re.MULTILINE)


def test_hooks_fetch_nothing() -> None:
    config = words(HOUSE / ".pre-commit-config.yaml")
    assert re.findall(r"^\s*- repo: (\S+)", config, re.MULTILINE) == ["local"]
    assert set(re.findall(r"^\s*language: (\S+)", config, re.MULTILINE)) == {"system"}


def test_a_stranger_that_takes_one_of_our_names_is_named(tmp_path) -> None:
    (tmp_path / "control").mkdir()
    (tmp_path / "control" / "__init__.py").write_text("", encoding="utf-8")
    script = f"import sys; sys.path[:0] = [{str(tmp_path)!r}]; sys.argv[1:] = ['--help']; from app.__main__ import main"
    words = [sys.executable, "-c", f"{script}; main()"]
    ran = subprocess.run(words, cwd=HOUSE, capture_output=True, text=True, check=False)
    assert ran.returncode == 1
    assert f"package 'control' is taken by {tmp_path.resolve()}" in ran.stderr
