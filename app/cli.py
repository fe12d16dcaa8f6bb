"""The command line: verbs are found as files in `app/commands`, and only the verb that is called is imported.

A verb is a file `app/commands/NAME.py` (an underscore in the file name is a dash in the verb) that defines `command`,
a `click.Command`; the first line of its docstring is its short help. Nothing else has to be touched to add one.
"""

from __future__ import annotations

import errno
import os
import sys
import traceback
from collections.abc import Sequence
from difflib import get_close_matches
from importlib import import_module
from pathlib import Path

import click

from hal.errors import LostMotionError

COMMANDS = Path(__file__).parent / "commands"


class LazyGroup(click.Group):
    """Finds verbs as files and imports a verb when it is called, so that `--help` is instant."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return sorted(path.stem.replace("_", "-") for path in COMMANDS.glob("[a-z]*.py"))

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        stem = cmd_name.replace("-", "_")
        if not (COMMANDS / f"{stem}.py").is_file():
            return None
        command = import_module(f"app.commands.{stem}").command
        assert isinstance(command, click.Command)
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        try:
            return super().resolve_command(ctx, args)
        except click.UsageError as error:
            near = get_close_matches(args[0], self.list_commands(ctx), 1)
            if not near:
                raise
            raise click.UsageError(f"{error.message.rstrip('.')}. Did you mean {near[0]}?", ctx) from error

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        rows = [(name, _short_help(name)) for name in self.list_commands(ctx)]
        if rows:
            with formatter.section("Commands"):
                formatter.write_dl(rows)


def _short_help(name: str) -> str:
    with (COMMANDS / f"{name.replace('-', '_')}.py").open(encoding="utf-8") as source:
        return source.readline().strip().strip('"')


@click.group(cls=LazyGroup, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 120})
@click.option("--debug", is_flag=True, help="Show the traceback of a failure.")
@click.version_option(package_name="lostmotion", prog_name="lostmotion")
def cli(debug: bool) -> None:
    """A bench for a pneumatic valve with backlash, and a diagnosis of its sim-to-real gap."""
    if debug:
        os.environ["LOSTMOTION_DEBUG"] = "1"


def run(argv: Sequence[str]) -> int:
    """Runs the command line and returns the exit code: 0 done, 1 failed, 2 bad usage or input, 130 interrupted."""
    try:
        result = cli.main(args=list(argv), prog_name="lostmotion", standalone_mode=False)
        return result if isinstance(result, int) else 0
    except click.exceptions.Exit as stop:
        return int(stop.exit_code)
    except click.exceptions.NoArgsIsHelpError as error:
        error.show()
        return 2
    except click.ClickException as error:
        return _fail(_usage(error), 2)
    except (KeyboardInterrupt, click.Abort) as stop:
        click.echo(f"lostmotion: interrupted{_noted(stop)}", err=True)
        return 130
    except LostMotionError as error:
        return _fail(f"{error}{_noted(error)}", error.exit_code)
    except BrokenPipeError:
        sys.stderr.close()
        return 1
    except Exception as error:
        if isinstance(error, OSError) and error.errno == errno.ENOSPC:
            return _fail(
                f"nothing more can be written ({error.strerror}); free the disk and run again{_noted(error)}", 1
            )
        return _fail(f"{type(error).__name__}: {error}; this is a defect, --debug shows where{_noted(error)}", 1)


def _noted(error: BaseException) -> str:
    """What somebody on the way up had to add: where the valve is. Click puts an exception of its own over Ctrl-C."""
    told = error.__cause__ if isinstance(error, click.Abort) else error
    return "".join(f"; {note}" for note in getattr(told, "__notes__", ()))


def _usage(error: click.ClickException) -> str:
    """Bad usage as one sentence that says where the help is."""
    sentence = " ".join(error.format_message().split()).rstrip(".")
    where = error.ctx.command_path if isinstance(error, click.UsageError) and error.ctx else "lostmotion"
    if isinstance(error, click.NoSuchOption) and error.option_name[1:2].isdigit():
        return f"'{error.option_name}' is read as an option; a negative number goes behind --, as in `{where} -- -1`"
    link = " See" if sentence.endswith("?") else "; see"
    return f"{sentence[:1].lower()}{sentence[1:]}{link} `{where} --help`"


def _fail(message: str, code: int) -> int:
    if os.environ.get("LOSTMOTION_DEBUG"):
        traceback.print_exc()
    click.echo(f"lostmotion: {message}", err=True)
    return code
