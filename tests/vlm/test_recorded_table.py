"""`recorded:FILE`: a VLM of one's own errs in simulation as its table of answers says."""

import csv
import gzip
from collections.abc import Iterable, Mapping
from pathlib import Path

import pytest

from tests.doubles import made
from tests.vlm.scene_truth import SceneTruth
from tpvqa.errors import PluginError, TpvqaError
from tpvqa.observation import Observation
from tpvqa.pddl import Atom, Task, load_task
from tpvqa.questions import FactQuestion, Way
from tpvqa.vlm import Reply
from tpvqa.vlm.making import in_full
from tpvqa.vlm.recorded.answers import Recordings, recordings
from tpvqa.vlm.recorded.spec import RecordedSpec


@pytest.fixture(scope="module")
def task() -> Task:
    return load_task("eat_apple")


def written(path: Path, rows: Iterable[Mapping[str, object]]) -> Path:
    rows = list(rows)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)
    return path


def as_rows(told: Recordings) -> list[dict[str, object]]:
    """What a model answered, a line each, in ViPlan's columns."""
    return [
        {
            "environment": told.environment,
            "model": told.model,
            "kind": kind,
            "fact": f"{predicate} a,b",
            "answer": "yes" if each.yes else "no",
            "p_yes": each.p_yes,
            "truth": int(truth),
        }
        for (kind, predicate, truth), found in told.by_kind.items()
        if predicate
        for each in found
        for _ in range(each.count)
    ]


def told_of(spec: str, task: Task) -> Recordings:
    return RecordedSpec.parse(spec).told(task)


def test_a_table_of_recorded_answers_is_that_model(tmp_path: Path, task: Task) -> None:
    shipped = recordings("internvl3-8b", "igibson")
    own = {key: found for key, found in shipped.by_kind.items() if key[1]}
    table = written(tmp_path / "mine.csv", as_rows(shipped))
    again = told_of(str(table), task)
    assert own
    assert own == {key: found for key, found in again.by_kind.items() if key[1]}
    packed = tmp_path / "mine.csv.gz"
    packed.write_bytes(gzip.compress(table.read_bytes()))
    assert told_of(str(packed), task) == again


@pytest.mark.parametrize("errors", ["fresh", "lasting"])
def test_it_errs_as_often_as_the_table_says_and_as_long(
    tmp_path: Path, task: Task, errors: str
) -> None:
    rows = [
        {"vlm": "mine", "fact": "(on a b)", "reply": "yes" if number < 3 else "no", "truth": False}
        for number in range(10)
    ] * 5
    rows += [{"vlm": "mine", "fact": "(near a)", "reply": "no", "truth": False}] * 50
    table = written(tmp_path / "mine.csv", rows)
    vlm = made(f"recorded:{table}:{errors}", truth=SceneTruth(), task=task)
    on, near = Atom("on", ("a", "b")), Atom("near", ("a",))
    questions = [FactQuestion(f"Is it on {n}?", Way.EFFECT, on) for n in range(3000)]
    looks = [vlm.ask(Observation(look=look, time=float(look)), questions) for look in range(2)]
    for answers in looks:
        yeses = sum(answer.reply is Reply.YES for answer in answers) / len(answers)
        assert yeses == pytest.approx(0.3, abs=0.04)
        assert {answer.p_yes for answer in answers} == {None}
    both = sum(a.reply is b.reply for a, b in zip(*looks, strict=True)) / len(questions)
    # .58 by chance; s² = .66 of the rest in an unchanged scene.
    assert both == pytest.approx(0.58 if errors == "fresh" else 0.86, abs=0.04)
    about_near = [FactQuestion(f"Is it near {n}?", Way.EFFECT, near) for n in range(50)]
    answers = vlm.ask(Observation(look=0, time=0.0), about_near)
    assert {answer.reply for answer in answers} == {Reply.NO}


def test_whose_answers_and_which_half_is_said_behind_the_file(tmp_path: Path, task: Task) -> None:
    rows = [
        {"model": model, "fact": "on a,b", "answer": answer, "truth": 1, "problem": number}
        for model, answer in (("one", "yes"), ("other", "no"))
        for number in range(200)
    ]
    table = written(tmp_path / "both.csv", rows)
    for model, yes in (("one", True), ("other", False)):
        halves = [told_of(f"{table}:{model}:{half}", task) for half in (0, 1)]
        counts = [found.by_kind["effect", "on", True] for found in halves]
        assert sum(each[0].count for each in counts) == 200
        assert all(each[0].yes is yes for each in counts)
    with pytest.raises(TpvqaError, match=r"2 models: one, other; say whose with recorded:"):
        told_of(str(table), task)
    with pytest.raises(TpvqaError, match=r"'oter'.*other"):
        told_of(f"{table}:oter", task)
    assert in_full(f"recorded:{table}:one:1") == f"recorded:{table}:one:1:lasting"


def test_the_environment_is_the_domains_or_the_only_other_one(tmp_path: Path, task: Task) -> None:
    def told(*places: str) -> Recordings:
        rows = [
            {"environment": place, "fact": "on", "answer": answer, "truth": 0}
            for place, answer in zip(places, ("yes", "no", "no"), strict=False)
        ]
        return told_of(str(written(tmp_path / f"{'-'.join(places)}.csv", rows)), task)

    assert told("blocksworld").environment == "blocksworld"
    assert told("blocksworld", "mine").environment == "mine"
    assert told(task.domain_name, "mine").environment == task.domain_name
    with pytest.raises(TpvqaError, match="2 environments: mine, yours"):
        told("mine", "yours")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("fact,answer\non,yes\n", r":1: no column is called 'truth'"),
        ("", r":1: no column is called 'fact' or 'predicate'"),
        ("fact,answer,truth\non,yes,2\n", r":2: truth is '2'; expected 1 or 0"),
        ("fact,answer,truth\non,perhaps,1\n", r"no yes or no beside a truth"),
        ("fact,answer,truth\non,yes,\n", r"no yes or no beside a truth"),
        ("fact,answer,truth\n (),yes,1\n", r":2: fact is '\(\)'; expected a predicate"),
        ("fact,answer,truth,kind\non,yes,1,what\n", r":2: kind is 'what'"),
        ("fact,answer,truth,p_yes\non,yes,1,nan\n", r":2: p_yes is 'nan'; expected a number"),
        ("fact,answer,truth,p_yes\non,yes,1,1e9\n", r":2: p_yes is '1e9'"),
        ("fact,answer,truth\non,yes\n", r":2: has 2 cells, too few for column 'truth'"),
        ('fact,answer,truth\n"on,yes,1\n', r":2: is no table \(unexpected end of data\)"),
    ],
)
def test_a_broken_table_is_told_with_its_line(
    tmp_path: Path, task: Task, text: str, said: str
) -> None:
    table = tmp_path / "mine.csv"
    table.write_text(text)
    with pytest.raises(TpvqaError, match=said):
        told_of(str(table), task)


def test_what_is_no_file_cannot_be_unpacked_or_is_no_text_is_told(
    tmp_path: Path, task: Task
) -> None:
    with pytest.raises(TpvqaError, match="there is no such table of answers"):
        told_of(str(tmp_path / "none.csv"), task)
    packed = tmp_path / "mine.csv.gz"
    packed.write_bytes(gzip.compress(b"fact,answer,truth\non,yes,1\n")[:-9])
    with pytest.raises(TpvqaError, match="cannot be unpacked"):
        told_of(str(packed), task)
    table = tmp_path / "mine.csv"
    table.write_bytes(b"fact,answer,truth\non,y\xe9s,1\n")
    with pytest.raises(TpvqaError, match=r":2: the byte 0xe9 is not UTF-8"):
        told_of(str(table), task)
    written(table, [{"fact": "on", "answer": "yes", "truth": 1}])
    with pytest.raises(TpvqaError, match=r"no column 'problem'.*leave out ':0'"):
        told_of(f"{table}:0", task)
    with pytest.raises(PluginError, match="is not understood"):
        told_of(f"{table}:one:two", task)
