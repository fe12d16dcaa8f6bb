"""A bank of labelled cases for calibration: `python bench/calibrate.py --cases N --seed S --out FILE.jsonl`.

Cases are dealt out evenly over kinds, faults and forms, with sizes from below the noise to far above it, on the plants
of one family, without the wire. Every case is one JSON line with its label, its strength, what the diagnosis said and
what it decided from. A file that is there already is gone on with. `--summary FILE` only prints.

Published blind trials come from other seeds and through the wire; nothing is ever tuned on them.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import time
from collections import Counter, defaultdict
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from app.blind.calibration import error
from app.blind.designs import baseline, margin
from app.blind.excite import commands, open_loop
from app.blind.features import decision_features, tempered
from app.blind.mark import mark
from app.blind.sizes import check_sizes
from app.blind.strength import stratum, strength
from logs.recording import Recording
from sim_device.physics.catalog import imperfections, make_physics, parameters
from sim_device.physics.imperfection import Imperfection
from sim_device.physics.offline import record
from sim_device.sealed import GRADES, Cause, Label
from twin.diagnose import Settings, diagnose
from twin.model.insert import inserted_from
from twin.search.search_rules import SearchRules

SHARES = {"effect": 0.50, "none": 0.14, "parameter": 0.12, "effects": 0.14, "outsider": 0.10}
TEMPERATURES = (1.0, 3.0, 10.0, 30.0, 100.0, 300.0)
_RANGE = (0.3, 1.2)  # sizes go from this share of a small one to this multiple of a large one


def labels(count: int, seed: int, family: str, only: str | None = None) -> list[Label]:
    """`count` labels; the same seed gives the same first ones however many are asked for."""
    kinds = _kinds(only)
    decks = {kind: _deck(kind, seed, family) for kind in SHARES}
    made = []
    for number in range(count):
        dice = random.Random(f"{seed}|{number}")
        kind = next(kinds)
        causes: tuple[Cause, ...] = ()
        if kind == "effects":
            causes = tuple(_cause(dice, item, form) for item, form in _two(decks["effects"]))
        elif kind != "none":
            causes = (_cause(dice, *next(decks[kind])),)
        made.append(Label(kind, family, dice.randrange(2**31), causes))
    return made


def _kinds(only: str | None) -> Iterator[str]:
    """Kinds in their shares, evenly mixed: each time the one that is furthest behind."""
    given: Counter[str] = Counter()
    while True:
        total = sum(given.values()) + 1
        kind = only or max(SHARES, key=lambda k: SHARES[k] * total - given[k])
        given[kind] += 1
        yield kind


def _deck(kind: str, seed: int, family: str) -> Iterator[tuple[Imperfection, str]]:
    """Every fault of a kind in every form, shuffled, again and again."""
    pool = parameters(family) if kind == "parameter" else imperfections(family)
    pool = tuple(item for item in pool if item.outsider == (kind == "outsider"))
    turn = 0
    while True:
        # One card per fault and turn: a fault with three forms is no more common than one with a single form.
        cards = [(item, item.forms[turn % len(item.forms)]) for item in pool]
        random.Random(f"{seed}|{kind}|{turn}").shuffle(cards)
        yield from cards
        turn += 1


def _two(deck: Iterator[tuple[Imperfection, str]]) -> list[tuple[Imperfection, str]]:
    first = next(deck)
    second = next(card for card in deck if card[0] is not first[0])
    return [first, second]


def _cause(dice: random.Random, item: Imperfection, form: str) -> Cause:
    """A size anywhere between lost in the noise and large, evenly on a logarithmic scale."""
    grade = dice.randrange(len(GRADES))
    low, high = _RANGE[0] * item.size(0, form), _RANGE[1] * item.size(2, form)
    size = low * (high / low) ** dice.random() if item.spread else item.size(grade, form)
    sign = -1.0 if item.signed and dice.random() < 0.5 else 1.0
    return Cause(item.name, item.stage, form, float(f"{item.within(sign * size):.4g}"), item.unit, "")


def solve(number: int, label: Label, share: float = 1.0) -> dict[str, object]:
    """Records the case offline, diagnoses it and returns its line."""
    time_s, command = commands(open_loop(label.physics_seed, share=share))
    effects = {cause.key: cause.size for cause in label.causes}
    physics = make_physics(label.family, label.physics_seed, effects=effects)
    pressure, position = record(physics, time_s, command)
    recording = Recording(f"case-{number}", time_s, command, position, pressure)
    design = baseline(label.family)
    began = time.perf_counter()
    settings = Settings(search=SearchRules(threads=1), margin=margin(label.family))
    outcome = diagnose([recording], design, inserted_from(design), settings)
    seconds = time.perf_counter() - began
    said = outcome.diagnosis.to_json()
    force = strength(label, time_s, command)
    kept = {key: said[key] for key in ("verdict", "causes", "confusable", "ranking", "gap", "noise")}
    return {
        "case": number,
        "label": asdict(label),
        "family": label.family,
        "ratio": force.ratio,
        "weakest": force.weakest,
        "stratum": stratum(force.ratio),
        **kept,
        "where_stage": said["where"]["stage"],  # type: ignore[index]
        "mark": asdict(mark(label, said)),
        "sizes": [asdict(check) for check in check_sizes(label, said, design)],
        "features": decision_features(outcome),
        "tempered": tempered(outcome, TEMPERATURES),
        "seconds": round(seconds, 2),
    }


def run(todo: list[tuple[int, Label]], out: Path, processes: int, share: float) -> None:
    """Solves what is to do, a line as soon as it is there; stop it with Ctrl-C and start it again."""
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")  # read by the workers when they import numpy; their threads only collide
    with out.open("a", encoding="utf-8") as file, ProcessPoolExecutor(processes, get_context("spawn")) as pool:
        jobs = {pool.submit(solve, number, label, share): number for number, label in todo}
        try:
            for done, job in enumerate(as_completed(jobs), start=1):
                try:
                    line = job.result()
                except Exception as error:  # a case that breaks the diagnosis is a finding, not an end
                    line = {"case": jobs[job], "error": f"{type(error).__name__}: {error}"}
                file.write(json.dumps(line) + "\n")
                file.flush()
                print(f"{done}/{len(todo)} {_words(line)}", flush=True)
        except KeyboardInterrupt:
            pool.shutdown(cancel_futures=True)
            raise SystemExit(130) from None


def _words(line: dict[str, object]) -> str:
    if "error" in line:
        return str(line["error"])
    label, causes = line["label"], line["causes"]
    truth = " + ".join(f"{c['name']}/{c['form']}={c['size']}" for c in label["causes"]) or "none"  # type: ignore[index]
    said = ", ".join(f"{c['name']} {c['probability']:.2f}" for c in causes)  # type: ignore[attr-defined]
    right = "right" if line["mark"]["right"] else "WRONG"  # type: ignore[index]
    return f"{right:5} {line['ratio']:6.1f}x {truth} -> {line['verdict']} {said}  [{line['seconds']} s]"


def summary(path: Path) -> None:
    """Prints accuracy per kind and stratum, and per fault."""
    lines = [json.loads(text) for text in path.read_text(encoding="utf-8").splitlines()]
    broken = [line for line in lines if "error" in line]
    kept = [line for line in lines if "error" not in line]
    groups: dict[tuple[str, str], list[bool]] = defaultdict(list)
    for line in kept:
        kind = line["label"]["kind"]
        groups[(kind, "all")].append(line["mark"]["right"])
        groups[(kind, line["stratum"])].append(line["mark"]["right"])
        for cause in line["label"]["causes"] if kind in ("effect", "outsider", "parameter") else ():
            groups[("  " + cause["name"], "all")].append(line["mark"]["right"])
    for (what, where), marks in sorted(groups.items(), key=lambda item: (item[0][0].startswith(" "), item[0])):
        print(f"{what:32} {where:9} {sum(marks):4d} of {len(marks):4d}  {100 * sum(marks) / len(marks):5.1f} %")
    if broken:
        print(f"{len(broken)} cases broke the diagnosis: {sorted({line['error'] for line in broken})}")


def temperatures(path: Path) -> None:
    """Prints what the causes named in a bank would have been worth at each temperature: log loss, Brier score, ECE."""
    lines = [json.loads(text) for text in path.read_text(encoding="utf-8").splitlines()]
    kept = [line for line in lines if "error" not in line]
    print("temperature  claims  log loss   Brier     ECE")
    for name in (f"{t:g}" for t in TEMPERATURES):
        claims = []
        for line in kept:
            true = {cause["name"] for cause in line["label"]["causes"]}
            claims += [(p, cause in true) for cause, p in line["tempered"][name].items()]
        said = np.array([p for p, _ in claims])
        right = np.array([float(hit) for _, hit in claims])
        loss = -float(np.mean(np.log(np.clip(np.where(right > 0.0, said, 1.0 - said), 1e-6, 1.0))))
        print(f"{name:>11}  {said.size:6}  {loss:8.3f}  {np.mean((said - right) ** 2):6.3f}  {error(claims):6.3f}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path)
    parser.add_argument("--family", default="thesis", choices=("thesis", "reference"))
    parser.add_argument("--only", choices=list(SHARES), help="cases of one kind")
    parser.add_argument("--share", type=float, default=1.0, help="length of the test sequence")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--summary", type=Path, help="only print what is in this file")
    parser.add_argument("--temperatures", type=Path, help="only print what is in this file, at every temperature")
    asked = parser.parse_args()
    if asked.temperatures:
        temperatures(asked.temperatures)
        return
    if asked.summary:
        summary(asked.summary)
        return
    if asked.out is None:
        parser.error("--out FILE.jsonl is needed")
    done = set()
    if asked.out.exists():
        done = {json.loads(text)["case"] for text in asked.out.read_text(encoding="utf-8").splitlines()}
    every = enumerate(labels(asked.cases, asked.seed, asked.family, asked.only))
    run([(number, label) for number, label in every if number not in done], asked.out, asked.processes, asked.share)
    summary(asked.out)


if __name__ == "__main__":
    main()
