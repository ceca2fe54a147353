"""Fit how recorded errors last: `python tools/lasting_errors.py SCENES.csv.gz ANSWERS.csv.gz`.

Reads whole scenes as the models of the ViPlan benchmark answered them (Merler et al. 2025, MIT),
every ground fact of a scene asked, again and again within a run, and writes
`packages/tpvqa/src/tpvqa/vlm/recorded/lasting.json`.

Two answers of one run to the same question about an unchanged fact are compared, each less the
model's rate of yes for the predicate and the truth. They correlate by

- c1, where the true state is the same in all facts,
- c2, where something else has changed.

By the model of `tpvqa.vlm.recorded` these are s² and (s k)²: an answer is with probability s the
scene's own draw, and this with probability k one for the whole trial. Where nothing was done in
between, the picture is the very same, and so is the answer: such pairs tell nothing of errors, and
are left out, but in blocksworld, where the pictures of a state never differ. Each run weighs as
one. Intervals are of 95%, by drawing problems anew; models are shrunk towards their environment's
mean by how much they differ beyond that (DerSimonian & Laird 1986).
"""

import argparse
import csv
import gzip
import json
import math
import random
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from compact_answers import SHORT

OUT = Path(__file__).parents[1] / "packages/tpvqa/src/tpvqa/vlm/recorded/lasting.json"
NEVER_CHANGE = ("leftof", "rightof")
SAME_PICTURES = "blocksworld"
ENOUGH = 30
"""Answers of one predicate and truth from which its rate of yes is taken."""
DRAWN = 400
KINDS = ("same scene", "other scene")
Row = Mapping[str, str]
Group = tuple[str, str, str, str]
Scene = dict[str, tuple[bool, str]]


@dataclass(slots=True)
class Sums:
    """Of one run and kind of pairs: products, squares, pairs."""

    product: float = 0.0
    square: float = 0.0
    pairs: int = 0

    def add(self, one: float, other: float) -> None:
        """Take in a pair of answers, each less its rate."""
        self.product += one * other
        self.square += (one * one + other * other) / 2
        self.pairs += 1


@dataclass(slots=True)
class Record:
    """What one model shows in one environment, by problem: the runs of each."""

    problems: dict[str, list[dict[str, Sums]]] = field(default_factory=lambda: defaultdict(list))

    def correlation(self, kind: str, problems: Sequence[str]) -> float:
        """The mean over runs, each by its mean pair; nan where there are none."""
        product = square = 0.0
        for problem in problems:
            for run in self.problems[problem]:
                sums = run.get(kind)
                if sums:
                    product += sums.product / sums.pairs
                    square += sums.square / sums.pairs
        return product / square if square else math.nan

    def pairs(self, kind: str) -> int:
        """How many pairs there are."""
        runs = (run for found in self.problems.values() for run in found)
        return sum(run[kind].pairs for run in runs if kind in run)

    def estimate(self, kind: str) -> tuple[float, float]:
        """The correlation, and its standard error by drawing problems anew."""
        names = sorted(self.problems)
        draw = random.Random(0)
        drawn = [self.correlation(kind, draw.choices(names, k=len(names))) for _ in range(DRAWN)]
        drawn = [each for each in drawn if not math.isnan(each)]
        mean = sum(drawn) / len(drawn)
        spread = math.sqrt(sum((each - mean) ** 2 for each in drawn) / len(drawn))
        return self.correlation(kind, names), spread


def main() -> None:
    """Fit, write and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("scenes", type=Path, help="folder with scenes.csv.gz and answers.csv.gz")
    parser.add_argument("answers", type=Path, help="the table of answers of the monitored runs")
    given = parser.parse_args()
    records = _records(given.scenes, _done(given.answers))
    fitted: dict[str, dict[str, dict[str, object]]] = {}
    for environment in sorted({key[0] for key in records}):
        names = sorted(model for where, model in records if where == environment)
        told = {
            kind: _shrunk({name: records[environment, name].estimate(kind) for name in names})
            for kind in KINDS
        }
        fitted[environment] = {
            name: _entry(records.get((environment, name)), name, told) for name in (*names, "")
        }
    OUT.write_text(json.dumps(fitted, indent=1) + "\n", encoding="utf-8")
    print(f"{OUT}: {OUT.stat().st_size} bytes")
    for environment, models in fitted.items():
        for name, entry in models.items():
            print(environment, name or "all", json.dumps(entry))
    for environment in fitted:
        pooled = Record()
        for (where, model), record in records.items():
            if where == environment:
                for problem, runs in record.problems.items():
                    pooled.problems[f"{model} {problem}"] = runs
        found = {_after(n): pooled.correlation(_after(n), [*pooled.problems]) for n in range(1, 9)}
        print(environment, {kind: round(each, 2) for kind, each in found.items()})


def _after(enumerations: int) -> str:
    """The kind of pairs in other scenes, by how much later the second one was."""
    return f"other scene, {min(enumerations, 8)} later"


def _entry(
    record: Record | None, name: str, told: Mapping[str, Mapping[str, tuple[float, float]]]
) -> dict[str, object]:
    """Shares of a model with intervals; of the environment under no name."""
    entry: dict[str, object] = {}
    (own, own_error), (other, other_error) = (told[kind][name] for kind in KINDS)
    own = min(max(own, 0.0), 1.0)
    bounds = [(m - 1.96 * e, m + 1.96 * e) for m, e in ((own, own_error), (other, other_error))]
    scene = math.sqrt(own)
    entry["scene"] = [_rounded(scene), *(_rounded(_root(b)) for b in bounds[0])]
    entry["trial"] = [_rounded(_root(each) / scene) for each in (other, *bounds[1])]
    if record is not None:
        entry["correlations"] = [round(record.estimate(kind)[0], 3) for kind in KINDS]
        entry["pairs"] = [record.pairs(kind) for kind in KINDS]
    return entry


def _root(correlation: float) -> float:
    return math.sqrt(min(max(correlation, 0.0), 1.0))


def _rounded(share: float) -> float:
    return round(min(share, 1.0), 3)


def _shrunk(told: Mapping[str, tuple[float, float]]) -> dict[str, tuple[float, float]]:
    """Each model's estimate drawn to the mean; the mean itself under no name."""
    usable = {name: (m, max(e, 0.01)) for name, (m, e) in told.items() if not math.isnan(m)}
    weights = {name: 1 / e**2 for name, (_, e) in usable.items()}
    total = sum(weights.values())
    mean = sum(weights[name] * usable[name][0] for name in usable) / total
    surplus = sum(weights[name] * (usable[name][0] - mean) ** 2 for name in usable)
    scale = total - sum(w * w for w in weights.values()) / total
    between = max(0.0, (surplus - (len(usable) - 1)) / scale) if scale else 0.0
    weights = {name: 1 / (e**2 + between) for name, (_, e) in usable.items()}
    total = sum(weights.values())
    mean = sum(weights[name] * usable[name][0] for name in usable) / total
    found = {"": (mean, math.sqrt(1 / total))}
    for name in told:
        m, e = usable.get(name, (mean, math.inf))
        own = between / (between + e**2) if between else 0.0
        variance = (own * e**2 if math.isfinite(e) else between) + (1 - own) ** 2 / total
        found[name] = (own * m + (1 - own) * mean if math.isfinite(e) else mean, variance**0.5)
    return found


def _records(
    folder: Path, done: Mapping[tuple[str, ...], set[int]]
) -> dict[tuple[str, str], Record]:
    scenes = {row["scene"]: row for row in _rows(folder / "scenes.csv.gz")}
    told: dict[str, Scene] = defaultdict(dict)
    counts: dict[Group, list[int]] = defaultdict(lambda: [0, 0])
    for row in _rows(folder / "answers.csv.gz"):
        if row["answer"] == "unknown" or row["fact"].split(" ")[0] in NEVER_CHANGE:
            continue
        told[row["scene"]][row["fact"]] = (row["answer"] == "yes", row["truth"])
        count = counts[_group(scenes[row["scene"]], row["fact"], row["truth"])]
        count[0] += row["answer"] == "yes"
        count[1] += 1
    rates = {group: yes / n for group, (yes, n) in counts.items() if n >= ENOUGH}
    runs: dict[tuple[str, ...], list[Row]] = defaultdict(list)
    for name, scene in scenes.items():
        if name in told:
            runs[_run(scene)].append(scene)
    found: dict[tuple[str, str], Record] = defaultdict(Record)
    for run, members in sorted(runs.items()):
        members.sort(key=lambda scene: int(scene["number"]))
        sums = _sums(members, told, rates, sorted(done.get(run, ())))
        environment, _, split, model, problem, _ = run
        found[environment, SHORT[model]].problems[f"{split} {problem}"].append(sums)
    return found


def _sums(
    members: Sequence[Row],
    told: Mapping[str, Scene],
    rates: Mapping[Group, float],
    acted: Sequence[int],
) -> dict[str, Sums]:
    """All pairs of scenes of one run."""
    sums: dict[str, Sums] = defaultdict(Sums)
    for place, one in enumerate(members):
        for other in members[place + 1 :]:
            here, there = told[one["scene"]], told[other["scene"]]
            shared = here.keys() & there.keys()
            same = len(shared) == max(len(here), len(there)) and all(
                here[fact][1] == there[fact][1] for fact in shared
            )
            if one["environment"] != SAME_PICTURES and not any(
                int(one["step"]) <= step < int(other["step"]) for step in acted
            ):
                continue
            for fact in sorted(shared):
                (yes, truth), (again, still) = here[fact], there[fact]
                rate = rates.get(_group(one, fact, truth))
                if truth == still and rate is not None:
                    sums[KINDS[not same]].add(yes - rate, again - rate)
                    if not same:
                        later = int(other["number"]) - int(one["number"])
                        sums[_after(later)].add(yes - rate, again - rate)
    return sums


def _done(answers: Path) -> dict[tuple[str, ...], set[int]]:
    """The steps of each run in which an action was done: its effects were asked about."""
    found: dict[tuple[str, ...], set[int]] = defaultdict(set)
    for row in _rows(answers):
        if row["kind"] == "effect":
            number = row["run"].removeprefix("results_").removesuffix(".json")
            found[_run({**row, "run": number})].add(int(row["step"]))
    return found


def _run(row: Row) -> tuple[str, ...]:
    names = ("environment", "setting", "split", "model", "problem", "run")
    return tuple(row[name] for name in names)


def _group(scene: Row, fact: str, truth: str) -> Group:
    return scene["environment"], scene["model"], fact.split(" ")[0], truth


def _rows(path: Path) -> Iterator[Row]:
    with gzip.open(path, "rt", encoding="utf-8") as file:
        yield from csv.DictReader(file)


if __name__ == "__main__":
    main()
