"""What the network finds on real photographs: `python benchmarks/real_photographs.py FOLDER`.

The folder holds photographs and a `labels.csv`: `file`, `split`, `group`, and a column for each
fact, 1 where it is true, 0 where it is not, empty where nobody can say. Each photograph is asked
about each fact in the words of the household's questions file. Nothing is learned from them.
"""

import argparse
import sys
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tpvqa.bench.statistics import wilson
from tpvqa.errors import AnswerError, TpvqaError
from tpvqa.pddl import Atom, Literal, load_task
from tpvqa.questions import QuestionBook
from tpvqa.tasks import find_task
from tpvqa.vlm import Reply
from tpvqa.vlm.metrics import auroc
from tpvqa.vlm.pictures import observe_file
from tpvqa_household.embedded import EmbeddedVLM
from tpvqa_household.training.labelled import COLUMNS, read_rows
from tpvqa_household.training.subjects import Subject

SURE = 0.05
"""An answer of a smaller P(yes) is a confident no."""


_RESAMPLES = 1000


@dataclass(frozen=True)
class Asked:
    """One answer to "Is there a … in the image?", "Is the fridge open?", "Is the TV turned on?".

    Attributes:
        thing: What was asked for.
        there: Whether it is in the picture, or the state is so.
        reply: The answer.
        p_yes: Its probability, where the answer has one.
        leaning: P(yes) before any abstention.
    """

    thing: str
    there: bool
    reply: Reply
    p_yes: float | None
    leaning: float


def _name(subject: Subject) -> str:
    (thing,) = subject.arguments
    return thing if subject.name == "near" else f"{thing} {subject.name}".replace("_", " ")


def ask_all(vlm: EmbeddedVLM, folder: Path, split: str) -> list[Asked]:
    """Ask for everything labelled in every photograph of a split."""
    book = QuestionBook.load(find_task("serve_breakfast").questions, load_task("serve_breakfast"))
    questions = {x: book.fact(Literal(Atom(x.name, x.arguments), True)) for x in COLUMNS}
    found = []
    for row in read_rows(folder):
        if row["split"] != split:
            continue
        labelled = [x for x, column in COLUMNS.items() if row[column] in ("0", "1")]
        asked, look = [questions[x] for x in labelled], observe_file(folder / row["file"])
        (frame,) = look.frames.values()
        told = zip(labelled, vlm.ask(look, asked), vlm.leanings(frame, asked), strict=True)
        for subject, answer, leaning in told:
            assert leaning is not None, answer.question.text
            there = row[COLUMNS[subject]] == "1"
            found.append(Asked(_name(subject), there, answer.reply, answer.p_yes, leaning))
    if not found:
        raise AnswerError(f"{folder / 'labels.csv'} has no labelled photographs of split {split!r}")
    return found


def table(asked: Sequence[Asked]) -> str:
    """Markdown: how well P(yes) tells, what was found, and what was not answered."""
    things: dict[str, list[Asked]] = defaultdict(list)
    for one in asked:
        things[one.thing].append(one)
    lines = [
        "| thing | there | AUROC | found | confident no | abstained "
        "| not there | said to be there | abstained |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for name, of in {**things, "all": list(asked)}.items():
        there = [one for one in of if one.there]
        absent = [one for one in of if not one.there]
        sure_no = (one.p_yes is not None and one.p_yes < SURE for one in there)
        area = "–" if name == "all" else _area(there, absent)
        lines.append(
            f"| {name} | {len(there)} | {area} | {_rate(one.reply is Reply.YES for one in there)} "
            f"| {_rate(sure_no)} | {_rate(one.reply is Reply.UNKNOWN for one in there)} "
            f"| {len(absent)} | {_rate(one.reply is Reply.YES for one in absent)} "
            f"| {_rate(one.reply is Reply.UNKNOWN for one in absent)} |"
        )
    return "\n".join(lines)


def _area(there: Sequence[Asked], absent: Sequence[Asked]) -> str:
    """AUROC of P(yes) before any abstention; its interval by the bootstrap, yes and no apart."""
    if not there or not absent:
        return "–"
    scores = [np.array([one.leaning for one in of]) for of in (there, absent)]
    truth = np.repeat([True, False], [len(there), len(absent)])
    rng = np.random.default_rng(0)
    drawn = [
        auroc(np.concatenate([rng.choice(of, len(of)) for of in scores]), truth) or 0.0
        for _ in range(_RESAMPLES)
    ]
    low, high = np.quantile(drawn, [0.025, 0.975])
    return f"{auroc(np.concatenate(scores), truth):.3f} ({low:.3f}–{high:.3f})"


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
