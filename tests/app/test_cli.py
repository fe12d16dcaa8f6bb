"""The roof: verbs as files, quick help, one sentence for every failure, exit codes, completion."""

from __future__ import annotations

import os
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from app.cli import COMMANDS, cli, run
from hal.errors import BadInput, JobFailed

VERBS = cli.list_commands(click.Context(cli))
HEAVY = ("numpy", "scipy", "numba", "pyarrow", "matplotlib", "rerun", "pydantic", "pymodbus")
#: What interfaces.md promises to scripts outside.
PROMISED = {
    "sweep", "identify", "run", "simulate", "diagnose", "blind", "emulate", "export", "demo", "ports", "check",
    "calibrate", "monitor", "runs", "show", "view", "jog", "set", "vent",
}  # fmt: skip


def python(code: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Runs code in a fresh interpreter, without anybody's BLAS settings."""
    kept = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")}
    kept |= environment
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=kept, check=False)


def test_every_file_is_a_verb_and_every_promised_verb_is_there() -> None:
    assert {name.replace("-", "_") for name in VERBS} == {path.stem for path in COMMANDS.glob("[a-z]*.py")}
    assert set(VERBS) >= PROMISED


@pytest.mark.parametrize("verb", VERBS)
def test_help_of_every_verb_says_what_it_does(verb) -> None:
    result = CliRunner().invoke(cli, [verb, "--help"], catch_exceptions=False)
    assert result.exit_code == 0
    assert result.output.startswith(f"Usage: cli {verb}")
    command = cli.get_command(click.Context(cli), verb)
    assert command is not None
    assert command.help
    assert len(command.help.split()) >= 4
    for option in command.params:
        assert not isinstance(option, click.Option) or option.help, f"{verb} {option.name} has no help"


def test_every_verb_has_a_short_help_that_is_a_sentence() -> None:
    listed = CliRunner().invoke(cli, ["--help"], terminal_width=200).output.partition("Commands:")[2]
    rows = [line.split(None, 1) for line in listed.splitlines() if line.strip()]
    assert [row[0] for row in rows] == VERBS
    assert all(len(row) == 2 and row[1].strip().endswith(".") for row in rows)


def test_help_imports_nothing_heavy() -> None:
    code = (
        "import sys; from app.cli import run; code = run(['--help']);"
        f"print([name for name in {HEAVY!r} if name in sys.modules], code)"
    )
    assert python(code).stdout.splitlines()[-1] == "[] 0"


@pytest.mark.parametrize("verb", VERBS)
def test_a_verb_imports_nothing_heavy_before_it_is_called(verb) -> None:
    """Its own module that is: what it needs, it imports when it runs."""
    path = Path(COMMANDS) / f"{verb.replace('-', '_')}.py"
    top = [line for line in path.read_text(encoding="utf-8").splitlines() if line.startswith(("import ", "from "))]
    assert [line for line in top if line.split()[1].partition(".")[0] in HEAVY] == []


def test_library_threads_are_one_unless_somebody_says_otherwise() -> None:
    code = (
        "import os, sys; sys.argv[1:] = ['--version']; from app.__main__ import main\n"
        "try: main()\nexcept SystemExit: print(os.environ['OPENBLAS_NUM_THREADS'], os.environ['OMP_NUM_THREADS'])"
    )
    assert python(code).stdout.splitlines()[-1] == "1 1"
    assert python(code, OMP_NUM_THREADS="4").stdout.splitlines()[-1] == "1 4"


def test_version(capsys) -> None:
    assert run(["--version"]) == 0
    assert capsys.readouterr().out.strip() == f"lostmotion, version {version('lostmotion')}"


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["swep"], "lostmotion: no such command 'swep'. Did you mean sweep? See `lostmotion --help`"),
        (["nosuch"], "lostmotion: no such command 'nosuch'; see `lostmotion --help`"),
        (["show"], "lostmotion: missing argument 'RUN'; see `lostmotion show --help`"),
        (
            ["runs", "--last", "0"],
            "lostmotion: invalid value for '--last': 0 is not in the range x>=1; see `lostmotion runs --help`",
        ),
        (["--nosuch"], "lostmotion: no such option '--nosuch'; see `lostmotion --help`"),
        (
            ["set", "-1"],
            "lostmotion: '-1' is read as an option; a negative number goes behind --, as in `lostmotion set -- -1`",
        ),
    ],
)  # fmt: skip
def test_bad_usage_is_one_sentence(capsys, words, sentence) -> None:
    assert run(words) == 2
    said = capsys.readouterr()
    assert said.err == f"{sentence}\n"
    assert said.out == ""


def test_a_misspelt_option_is_recognised(capsys) -> None:
    assert run(["runs", "--lats", "3"]) == 2
    assert "Did you mean '--last'? See `lostmotion runs --help`" in capsys.readouterr().err


def test_nothing_shows_the_help(capsys) -> None:
    assert run([]) == 2
    assert "Commands:" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("raised", "code", "said"),
    [
        (BadInput("row 7 is wrong"), 2, "lostmotion: row 7 is wrong"),
        (JobFailed("no reply"), 1, "lostmotion: no reply"),
        (KeyboardInterrupt(), 130, "lostmotion: interrupted"),
        (click.Abort(), 130, "lostmotion: interrupted"),
        (ZeroDivisionError("by nought"), 1, "lostmotion: ZeroDivisionError: by nought; this is a defect"),
    ],
)
def test_exit_codes_and_sentences(monkeypatch, capsys, raised, code, said) -> None:
    @click.command()
    def fails() -> None:
        raise raised

    monkeypatch.delenv("LOSTMOTION_DEBUG", raising=False)
    monkeypatch.setattr(cli, "get_command", lambda context, name: fails)
    assert run(["runs"]) == code
    errors = capsys.readouterr().err
    assert errors.lstrip().startswith(said)  # click leaves the line that ^C stands on
    assert "Traceback" not in errors


def test_debug_shows_the_traceback(monkeypatch, capsys) -> None:
    monkeypatch.setenv("LOSTMOTION_DEBUG", "")  # so that what --debug sets is taken back
    assert run(["--debug", "show", "nosuch"]) == 2
    assert "Traceback" in capsys.readouterr().err


def complete(words: str, at: int) -> list[str]:
    """What bash would offer, without the kinds."""
    code = "from app.__main__ import main; main()"
    asked = {"_LOSTMOTION_COMPLETE": "bash_complete", "COMP_WORDS": words, "COMP_CWORD": str(at)}
    return [line.partition(",")[2] for line in python(code, **asked).stdout.splitlines()]


def test_the_shell_completes_verbs_and_options() -> None:
    assert complete("lostmotion ex", 1) == ["explain", "export"]
    assert "--profile" in complete("lostmotion sweep --p", 2)


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_shell_gets_its_script(shell) -> None:
    script = python("from app.__main__ import main; main()", _LOSTMOTION_COMPLETE=f"{shell}_source")
    assert "_LOSTMOTION_COMPLETE" in script.stdout
    assert script.returncode == 0
