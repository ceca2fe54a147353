"""What the embedded network learns of others' domains: `python -m benchmarks.own_pictures FOLDER`.

Pictures of a workshop are made in FOLDER (once: 1,624 of them, with what the network makes of them
some ten minutes of a core; the rest takes five). Of 512 pictures 8, 16, … are drawn, five times
each, taught as `tpvqa train embedded` does, and asked about 300 others: once in the same workshop,
with other cameras, light and clutter, and once in workshops that were never seen. With
`--photographs` (a `labels.csv` as `benchmarks/real_photographs.py` reads it) its part train teaches
and its part test measures, beside the network as it ships.
"""

import argparse
import json
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks import workshop_scenes
from benchmarks.real_photographs import Asked, table
from tpvqa.chance import chance_array
from tpvqa.observation import Frame
from tpvqa.pddl import Atom, Literal, load_task
from tpvqa.pictures import read_picture
from tpvqa.questions import FactQuestion, QuestionBook, Way
from tpvqa.tasks import find_task
from tpvqa.training.example import Example
from tpvqa.training.from_pictures import examples_of
from tpvqa.training.protocol import TrainingSettings
from tpvqa.vlm import Reply
from tpvqa.vlm.metrics import auroc
from tpvqa.vlm.pictures import observe_file
from tpvqa.worlds.pictures import MANIFEST, load_set, media_type
from tpvqa_household.embedded import EmbeddedVLM
from tpvqa_household.embedded.likeness import Floats
from tpvqa_household.embedded.sessions import Sessions
from tpvqa_household.embedded.taught.folder import spoken
from tpvqa_household.embedded.taught.sight import WIDE
from tpvqa_household.embedded.taught.vlm import TaughtVLM
from tpvqa_household.embedded.weights import Weights
from tpvqa_household.images.manifest import load_pictures
from tpvqa_household.teaching.glimpses import glimpses, views_of
from tpvqa_household.teaching.heads import fit_heads, folds_of
from tpvqa_household.teaching.kinds import known_pictures
from tpvqa_household.teaching.lessons import LEAST, lessons_of
from tpvqa_household.teaching.trainer import EmbeddedTrainer
from tpvqa_household.training.labelled import COLUMNS, read_rows

SIZES = (8, 16, 32, 64, 128, 256, 512)
DRAWS = {8: 5, 16: 5, 32: 5, 64: 5, 128: 5, 256: 5, 512: 1}
"""Of pictures, by their number; of 512 there is one."""
VIEWS = 3
KINDS = {"one": "the same workshop", "any": "workshops never seen"}
_TEST, _TESTED = 100_000, 300
_OTHER = 60
OWN_WORDS = {
    "holds_something": "Is something held in a hand or a gripper?",
    "cooking_scene": "Is food being cooked?",
}
"""Labels of the photographs that the shipped network has no words for."""


@dataclass(frozen=True)
class Seen:
    """Pictures by the frozen branch, with their labels.

    Attributes:
        features: Views × n × features.
        kinds: n × features that tell kinds of pictures apart.
        labels: n × questions: 1, 0, -1 where the picture does not show it.
    """

    features: Floats
    kinds: Floats
    labels: NDArray[np.int64]


@dataclass(frozen=True)
class Figures:
    """Of one draw of pictures, over all questions, on the test pictures.

    Attributes:
        auroc: Mean over the questions; .5 for one that was not learnt.
        balanced: Balanced accuracy, the same; *unknown* counts as wrong.
        unknown: Share of the answers that are unknown.
        by_question: AUROC of each.
        alarms: Share of the test pictures that are taken for unlike.
        told: Share of kitchens and of other workshops that are.
    """

    auroc: float
    balanced: float
    unknown: float
    by_question: tuple[float, ...]
    alarms: float
    told: tuple[float, float]


def _book(folder: Path) -> QuestionBook:
    task = load_task(folder / "domain.pddl", folder / "problem.pddl")
    return QuestionBook.load(folder / "questions.yaml", task)


def _made(folder: Path, kind: str, part: str) -> Path:
    """The pictures of a part; made where they are not there."""
    where = folder / f"{kind}-{part}"
    if not (where / MANIFEST).is_file():
        numbers = range(_TEST, _TEST + _TESTED) if part == "test" else range(SIZES[-1])
        workshop_scenes.make(where, numbers, anywhere=kind == "any")
    return where


def _seen(branch: Sessions, where: Path, views: int) -> Seen:
    pictures = load_set(where)
    book = _book(where)
    lessons = lessons_of(list(examples_of(pictures, [book])))
    assert not lessons.unlearnt
    order = [lessons.questions.index(spoken(text)) for text in workshop_scenes.QUESTIONS.values()]
    features, kinds = glimpses(
        branch, lessons.pictures, where, views=views, seed=0, done=lambda _: None
    )
    return Seen(features, kinds, lessons.labels[:, order])


def _kitchens(branch: Sessions, folder: Path) -> Floats:
    pictures = load_pictures()
    some = pictures.manifest.pictures[:: len(pictures.manifest.pictures) // _OTHER]
    examples = [Example(pictures.read(each), media_type(each.file), "", True) for each in some]
    where = folder / "kitchens"
    where.mkdir(exist_ok=True)
    return glimpses(branch, examples, where, views=1, seed=0, done=lambda _: None)[1]


def measured(
    taught: Seen, rows: NDArray[np.intp], test: Seen, others: Sequence[Floats], *, wide: int = 0
) -> Figures:
    """Teach some pictures, and ask about the test pictures.

    Args:
        taught: What may be taught.
        rows: Which of them are.
        test: What is asked about.
        others: Kinds of pictures of other domains.
        wide: How many features are used; all by default.
    """
    labels = taught.labels[rows]
    enough = [i for i in range(labels.shape[1]) if _fewest(labels[:, i]) >= LEAST]
    alone = rows.astype(str)
    known = known_pictures(taught.kinds[rows], folds_of(alone, 0))
    within = known.distance(test.kinds) <= 1
    odds = np.full(test.labels.shape, np.nan)
    if enough:
        some = slice(None, wide or None)
        views = views_of(len(rows), len(taught.features))
        fit = fit_heads(taught.features[:views, rows, some], labels[:, enough], alone)
        odds[:, enough] = test.features[0][:, some] @ fit.weights.T + fit.bias
    areas, rights, unknown = [], [], []
    for column in range(labels.shape[1]):
        asked = test.labels[:, column] >= 0
        truth, z, said = test.labels[asked, column] == 1, odds[asked, column], within[asked]
        said = said & ~np.isnan(z)
        right = said & ((z > 0) == truth)
        areas.append(0.5 if np.isnan(z).any() else auroc(z, truth) or 0.0)
        rights.append((right[truth].mean() + right[~truth].mean()) / 2)
        unknown.append(1 - said.mean())
    told = tuple(float((known.distance(other) > 1).mean()) for other in others)
    return Figures(
        float(np.mean(areas)),
        float(np.mean(rights)),
        float(np.mean(unknown)),
        tuple(areas),
        float(1 - within.mean()),
        (told[0], told[1]),
    )


def _fewest(labels: NDArray[np.int64]) -> int:
    return min(int((labels == 1).sum()), int((labels == 0).sum()))


def _rows(size: int, draw: int) -> NDArray[np.intp]:
    order = chance_array(draw, 0, "pictures of a curve").permutation(SIZES[-1])
    return np.asarray(order[:size], np.intp)


def curve(taught: Seen, test: Seen, others: Sequence[Floats]) -> dict[int, list[Figures]]:
    """Figures by number of pictures, one for each draw."""
    return {
        size: [measured(taught, _rows(size, draw), test, others) for draw in range(DRAWS[size])]
        for size in SIZES
    }


def _spread(values: Sequence[float]) -> str:
    return f"{np.mean(values):.2f} ({min(values):.2f}–{max(values):.2f})"


def curve_table(found: dict[int, list[Figures]]) -> str:
    """Markdown: by number of pictures the mean of the draws, and the least and the most."""
    lines = [
        "| pictures | AUROC | balanced accuracy | unknown | false alarms | kitchens told "
        "| other workshops told |",
        "|---|---|---|---|---|---|---|",
    ]
    for size, draws in found.items():
        cells = [
            [each.auroc for each in draws],
            [each.balanced for each in draws],
            [each.unknown for each in draws],
            [each.alarms for each in draws],
            [each.told[0] for each in draws],
            [each.told[1] for each in draws],
        ]
        lines.append(f"| {size} | " + " | ".join(map(_spread, cells)) + " |")
    return "\n".join(lines)


def question_table(found: dict[int, list[Figures]]) -> str:
    """Markdown: AUROC of each question, by number of pictures."""
    sizes = list(found)
    lines = [
        "| question | " + " | ".join(map(str, sizes)) + " |",
        "|---|" + "---|" * len(sizes),
    ]
    for number, text in enumerate(workshop_scenes.QUESTIONS.values()):
        cells = [f"{np.mean([d.by_question[number] for d in found[size]]):.2f}" for size in sizes]
        lines.append(f"| {text} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def plot(curves: dict[str, dict[int, list[Figures]]], file: Path) -> None:
    """Draw AUROC and balanced accuracy over the number of pictures."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(1, 2, figsize=(9, 3.6), sharex=True, sharey=True)
    colours = {"one": "#1f77b4", "any": "#d95f02"}
    for axis, name, title in zip(
        axes, ("auroc", "balanced"), ("AUROC", "balanced accuracy"), strict=True
    ):
        for kind, found in curves.items():
            sizes = list(found)
            rows = [[getattr(each, name) for each in found[size]] for size in sizes]
            means, least, most = ([of(row) for row in rows] for of in (np.mean, min, max))
            axis.plot(sizes, means, "o-", color=colours[kind], label=KINDS[kind])
            axis.fill_between(sizes, least, most, color=colours[kind], alpha=0.2, lw=0)
        axis.axhline(0.5, color="grey", lw=0.8, ls=":")
        axis.set_xscale("log", base=2)
        axis.set_xticks(SIZES, [str(size) for size in SIZES])
        axis.set_ylim(0, 1.02)
        axis.set_xlabel("labelled pictures")
        axis.set_title(title)
        axis.grid(alpha=0.25)
    axes[0].legend(loc="lower right", frameon=False)
    figure.tight_layout()
    figure.savefig(file, dpi=110)


def sheet(folder: Path, file: Path) -> None:
    """The first test pictures of both kinds, as one picture."""
    from PIL import Image

    made = Image.new("RGB", (6 * 160, 2 * 120))
    for row, kind in enumerate(KINDS):
        pictures = load_set(folder / f"{kind}-test")
        for column, each in enumerate(pictures.manifest.pictures[:6]):
            with Image.open(pictures.folder / each.file) as picture:
                made.paste(picture.resize((160, 120)), (160 * column, 120 * row))
    made.save(file, quality=85)


# Real photographs


def _questions() -> dict[str, str]:
    """The labels' columns with the words of the household, and two that it has no words for."""
    book = QuestionBook.load(find_task("serve_breakfast").questions, load_task("serve_breakfast"))
    words = {
        column: book.fact(Literal(Atom(subject.name, subject.arguments), True)).text
        for subject, column in COLUMNS.items()
    }
    return words | OWN_WORDS


def _of_photographs(folder: Path) -> Iterator[Example]:
    for row in read_rows(folder):
        for column, text in _questions().items():
            if row["split"] == "train" and row[column] in ("0", "1"):
                data, kind = read_picture(folder / row["file"]), media_type(row["file"])
                yield Example(data, kind, text, row[column] == "1", column, row["group"])


def photographs(folder: Path, scratch: Path) -> dict[str, list[Asked]]:
    """What the taught network and the shipped one say of the test part."""
    out = scratch / "photographs-taught"
    if not out.is_dir():
        under_way = scratch / "photographs"
        under_way.mkdir(exist_ok=True)
        trainer = EmbeddedTrainer()
        examples = list(_of_photographs(folder))
        trainer.fit(
            examples, under_way, settings=TrainingSettings(), progress=lambda done, total: None
        )
        print("\n".join(trainer.notices), file=sys.stderr)
        trainer.save(out)
    found: dict[str, list[Asked]] = {"taught": [], "as it ships": []}
    shipped, taught, words = EmbeddedVLM(), TaughtVLM(out), _questions()
    for row in read_rows(folder):
        columns = [column for column in words if row[column] in ("0", "1")]
        if row["split"] != "test" or not columns:
            continue
        look = observe_file(folder / row["file"])
        (frame,) = look.frames.values()
        assert isinstance(frame, Frame)
        asked = [FactQuestion(words[c], Way.PRECONDITION, Atom("asked")) for c in columns]
        for name, vlm in (("taught", taught), ("as it ships", shipped)):
            told = zip(columns, vlm.ask(look, asked), vlm.leanings(frame, asked), strict=True)
            for column, answer, leaning in told:
                there = row[column] == "1"
                lean = 0.5 if leaning is None else leaning
                found[name].append(
                    Asked(column.replace("_", " "), there, answer.reply, answer.p_yes, lean)
                )
    return found


def main() -> int:
    """Make what is missing, measure, and print the tables."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", type=Path, help="pictures and their features are made in it")
    parser.add_argument("--photographs", type=Path, help="photographs with their labels.csv")
    parser.add_argument("--images", type=Path, help="where plot and sheet are written")
    given = parser.parse_args()
    folder = given.folder
    folder.mkdir(parents=True, exist_ok=True)
    branch = Sessions(Weights.read(), threads=1)
    taught = {kind: _seen(branch, _made(folder, kind, "train"), VIEWS) for kind in KINDS}
    test = {kind: _seen(branch, _made(folder, kind, "test"), 1) for kind in KINDS}
    kitchens, curves = _kitchens(branch, folder), {}
    for kind, name in KINDS.items():
        other = test["one" if kind == "any" else "any"].kinds
        curves[kind] = curve(taught[kind], test[kind], (kitchens, other))
        print(f"\n{name}\n\n{curve_table(curves[kind])}\n\n{question_table(curves[kind])}")
        rows = [_rows(128, draw) for draw in range(DRAWS[128])]
        plain = Seen(taught[kind].features[:1], taught[kind].kinds, taught[kind].labels)
        for what, of, wide in (
            ("one view of each picture", plain, 0),
            ("one view, and no parts", plain, WIDE),
        ):
            areas = [measured(of, r, test[kind], (kitchens, other), wide=wide).auroc for r in rows]
            print(f"128 pictures, {what}: AUROC {_spread(areas)}")
    words = workshop_scenes.QUESTIONS.values()
    asked = [FactQuestion(text, Way.PRECONDITION, Atom("asked")) for text in words]
    shipped, first = EmbeddedVLM(), load_set(folder / "one-test").manifest.pictures[0].file
    answers = shipped.ask(observe_file(folder / "one-test" / first), asked)
    unknown = sum(answer.reply is Reply.UNKNOWN for answer in answers)
    print(f"\nthe network as it ships: {unknown} of {len(asked)} questions unknown")
    if given.images is not None:
        plot(curves, given.images / "own-pictures.png")
        sheet(folder, given.images / "workshop-pictures.jpg")
    told = {
        kind: {size: [each.auroc for each in draws] for size, draws in found.items()}
        for kind, found in curves.items()
    }
    (folder / "curves.json").write_text(json.dumps(told, indent=1), encoding="utf-8")
    if given.photographs is not None:
        for name, answered in photographs(given.photographs, folder).items():
            print(f"\nphotographs, {name}\n\n{table(answered)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
