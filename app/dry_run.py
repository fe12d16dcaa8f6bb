"""What is known of a bench before it is touched, and what a run on it would be refused for."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from hal.bench import BenchInfo
    from hal.profile import Profile


def bench_unopened(profile: Profile, port: str | None) -> BenchInfo:
    """The bench as `open_bench` would open it; without a port the virtual one, which has no bits on a wire."""
    from hal.bench_info import info_of

    return info_of(profile.paced("none")) if port is None else info_of(profile, port)


def check_files(profile: Profile, out: Path | None, twin: Path | None = None) -> None:
    """Raises: `BadInput` for a folder of the record, or a model beside the bench, that the run would be refused for."""
    from app.targets import check_new_run
    from app.twin_beside import plant_beside

    check_new_run(out)
    if twin is not None:
        plant_beside(twin, profile.command_unit)
