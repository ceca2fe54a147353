"""What the network finds on real photographs: `python benchmarks/real_photographs.py FOLDER`.

The folder holds photographs and a `labels.csv`: `file`, `split`, and a column for each thing, 1
where it is in the picture, 0 where it is not, empty where nobody can say. Each photograph is asked
for each thing in the words of the household's questions file. Nothing is learned from them.
"""

import argparse
import csv
import sys
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from tpvqa.bench.statistics import wilson
from tpvqa.errors import AnswerError, TpvqaError
from tpvqa.pddl import Atom, Literal, load_task
from tpvqa.questions import QuestionBook
from tpvqa.tasks import find_task
from tpvqa.vlm import VLM, Reply
from tpvqa.vlm.pictures import observe_file
from tpvqa_household.embedded import EmbeddedVLM

COLUMNS = {
    "fridge": "refrigerator",
    "sink": "sink",
    "tv": "tv",
    "table": "table",
    "counter": "counter",
    "knife": "knife",
    "apple": "apple",
    "bread": "bread",
    "plate": "plate_or_bowl",
}
"""The labels' column of each thing; bowls count as plates."""
SURE = 0.05
"""An answer of a smaller P(yes) is a confident no."""


@dataclass(frozen=True)
class Asked:
    """One answer to "Is there a … in the image?".

    Attributes:
        thing: What was asked for.
        there: Whether it is in the picture.
        reply: The answer.
        p_yes: Its probability, where the answer has one.
    """

    thing: str
    there: bool
    reply: Reply
    p_yes: float | None


def ask_all(vlm: VLM, folder: Path, split: str) -> list[Asked]:
    """Ask for every labelled thing in every photograph of a split."""
    book = QuestionBook.load(find_task("serve_breakfast").questions, load_task("serve_breakfast"))
    questions = {x: book.fact(Literal(Atom("near", (x,)), True)) for x in COLUMNS}
    found = []
    for row in _labels(folder / "labels.csv"):
        if row["split"] != split:
            continue
        labelled = [x for x, column in COLUMNS.items() if row[column] in ("0", "1")]
        answers = vlm.ask(observe_file(folder / row["file"]), [questions[x] for x in labelled])
        found += [
            Asked(x, row[COLUMNS[x]] == "1", answer.reply, answer.p_yes)
            for x, answer in zip(labelled, answers, strict=True)
        ]
    if not found:
        raise AnswerError(f"{folder / 'labels.csv'} has no labelled photographs of split {split!r}")
    return found


def _labels(file: Path) -> list[dict[str, str]]:
    try:
        with file.open(encoding="utf-8", newline="") as lines:
            rows = list(csv.DictReader(lines))
    except (OSError, UnicodeDecodeError) as error:
        raise AnswerError(f"{file} cannot be read: {error}") from error
    lacking = {"file", "split", *COLUMNS.values()} - set(rows[0] if rows else ())
    if lacking:
        raise AnswerError(f"{file} lacks the columns {', '.join(sorted(lacking))}")
    return rows


def table(asked: Sequence[Asked]) -> str:
    """Markdown: what was found of what is there, and what was seen where it is not."""
    things: dict[str, list[Asked]] = defaultdict(list)
    for one in asked:
        things[one.thing].append(one)
    lines = [
        "| thing | there | found | confident no | not there | said to be there |",
        "|---|---|---|---|---|---|",
    ]
    for name, of in {**things, "all": list(asked)}.items():
        there = [one for one in of if one.there]
        absent = [one for one in of if not one.there]
        sure_no = (one.p_yes is not None and one.p_yes < SURE for one in there)
        lines.append(
            f"| {name} | {len(there)} | {_rate(one.reply is Reply.YES for one in there)} "
            f"| {_rate(sure_no)} | {len(absent)} "
            f"| {_rate(one.reply is Reply.YES for one in absent)} |"
        )
    return "\n".join(lines)


def _rate(hits: Iterable[bool]) -> str:
    counted = list(hits)
    if not counted:
        return "–"
    rate = wilson(sum(counted), len(counted))
    return f"{rate.rate:.2f} ({rate.low:.2f}–{rate.high:.2f})"


def main() -> int:
    """Print the table for one split."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", type=Path, help="photographs with their labels.csv")
    parser.add_argument("--split", default="test", help="which of them; default: test")
    given = parser.parse_args()
    try:
        print(table(ask_all(EmbeddedVLM(), given.folder, given.split)))
    except TpvqaError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
