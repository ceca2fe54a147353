"""How much of the errors outlasts a change of the scene, from whole scenes as VLMs saw them.

python experiments/tools/viplan_lasting.py FOLDER, with `scenes.csv.gz` and `answers.csv.gz` in it.

Of every two looks at everything in an episode of blocksworld, one after the other, between which a
block was moved, it takes the facts that stayed as they were. If a share s of the facts keeps its
answer through the trial and the others are answered as in another scene of the same shape, then
P(wrong | wrong before) - P(wrong | right before) = s + (1 - s) d, with d the same difference where
the second look is at a scene of another problem. It prints s with a 95% bootstrap interval over
pairs of looks, by model and by the number of actions between them.
"""

import argparse
import random
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path

from viplan_scenes import SHORT, columns_of, table

from tpvqa_experiments.viplan.noise import apart, as_seen
from tpvqa_experiments.viplan.scenes import Arrangement, Fact, facts_of, scenes, true_facts

DRAWS, RESAMPLES = 5, 200
Counts = Counter[tuple[str, bool]]
"""Facts, those wrong afterwards, those wrong in drawn scenes; by whether wrong before."""


class Look:
    """A look at everything.

    Args:
        row: Of the table of scenes.
        answers: What was affirmed, and what held, by fact.
    """

    def __init__(self, row: Mapping[str, str], answers: Mapping[str, tuple[bool, bool]]):
        self.model, self.problem = SHORT[row["model"]], row["problem"]
        self.episode = tuple(row[name] for name in ("setting", "model", "run", "problem"))
        self.number, self.step = int(row["number"]), int(row["step"])
        self.columns: Arrangement = tuple(columns_of(answers))
        self.true = true_facts(self.columns)
        self._answers = answers

    def wrong(self, fact: Fact) -> bool:
        """Whether the answer about a fact was."""
        affirmed, held = self._answers[f"{fact[0]} {','.join(fact[1:])}"]
        return affirmed != held


def looks_in(folder: Path) -> Iterator[Look]:
    """The looks of blocksworld."""
    told = {
        row["scene"]: row
        for row in table(folder / "scenes.csv.gz")
        if row["environment"] == "blocksworld"
    }
    answers: dict[str, dict[str, tuple[bool, bool]]] = defaultdict(dict)
    for row in table(folder / "answers.csv.gz"):
        if row["scene"] in told and row["answer"] != "unknown":
            answers[row["scene"]][row["fact"]] = row["answer"] == "yes", row["truth"] == "1"
    return (Look(row, answers[scene]) for scene, row in told.items())


def counted(before: Look, after: Look, draw: random.Random) -> Counts:
    """What two looks tell of the facts that stayed as they were."""
    heights = tuple(map(len, after.columns))
    others = [
        scene
        for scene in scenes(after.model)
        if scene.initial
        and scene.problem != after.problem
        and (len(scene.heights), sum(scene.heights)) == (len(heights), sum(heights))
    ]
    least = min(apart(scene.heights, heights) for scene in others)
    alike = [scene for scene in others if apart(scene.heights, heights) == least]
    drawn = [as_seen(after.columns, draw.choice(alike), draw) for _ in range(DRAWS)]
    found: Counts = Counter()
    for fact in facts_of(after.columns):
        held = fact in after.true
        if held == (fact in before.true):
            was = before.wrong(fact)
            found["facts", was] += DRAWS
            found["wrong", was] += DRAWS * after.wrong(fact)
            found["drawn", was] += sum(seen[fact] != held for seen in drawn)
    return found


def share(pairs: Iterable[Counts]) -> float | None:
    """The share of facts whose answers last; None where no answer was wrong."""
    total: Counts = Counter()
    for each in pairs:
        total.update(each)
    if not (total["facts", True] and total["facts", False]):
        return None

    def difference(of: str) -> float:
        return total[of, True] / total["facts", True] - total[of, False] / total["facts", False]

    return (difference("wrong") - difference("drawn")) / (1 - difference("drawn"))


def say(name: str, pairs: Sequence[Counts]) -> None:
    """Print the share with its interval."""
    draw = random.Random(0)
    again = (share(draw.choices(pairs, k=len(pairs))) for _ in range(RESAMPLES))
    found = sorted(each for each in again if each is not None)
    least, most = found[len(found) // 40], found[-len(found) // 40]
    print(f"{name:20} {len(pairs):4} pairs  {share(pairs) or 0:.2f} ({least:.2f}-{most:.2f})")


def main() -> None:
    """Print what was found."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", type=Path)
    episodes: dict[tuple[str, ...], list[Look]] = defaultdict(list)
    for look in looks_in(parser.parse_args().folder):
        episodes[look.episode].append(look)
    draw = random.Random(0)
    by_model: dict[str, list[Counts]] = defaultdict(list)
    by_steps: dict[str, list[Counts]] = defaultdict(list)
    for looks in episodes.values():
        looks.sort(key=lambda look: look.number)
        for before, after in pairwise(looks):
            steps = after.step - before.step  # none between two runs of one problem
            if before.columns != after.columns and steps > 0:
                pair = counted(before, after, draw)
                by_model[after.model].append(pair)
                by_steps[str(steps) if steps < 3 else "3 or more"].append(pair)
    for model, pairs in sorted(by_model.items()):
        say(model, pairs)
    for name, pairs in sorted(by_steps.items()):
        say(f"{name} actions between", pairs)
    say("all", [pair for pairs in by_model.values() for pair in pairs])


if __name__ == "__main__":
    main()
