"""VLMs side by side: figures against independent tools, and the command."""

import csv
import json
import random
from collections.abc import Sequence
from pathlib import Path
from shutil import copytree
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sklearn import metrics as sklearn_metrics

from tests.cli.conftest import Run, tpvqa  # noqa: F401
from tests.conftest import Install
from tests.lamps import DOMAIN, PROBLEM, QUESTIONS, edit, make_set, without
from tpvqa.bench.vlms.asking import Row
from tpvqa.bench.vlms.comparing import compare
from tpvqa.bench.vlms.lasting import lasting_errors
from tpvqa.bench.vlms.scoring import difference, score
from tpvqa.questions import Way
from tpvqa.vlm import Reply
from tpvqa.vlm.kept.upkeep import stats
from tpvqa.vlm.metrics import Scored, calibration_error, measure


def row(**told: Any) -> Row:
    known: dict[str, Any] = {
        "vlm": "any",
        "look": "1",
        "cluster": "1",
        "scene": "1",
        "way": Way.PRECONDITION,
        "predicate": "on",
        "fact": "(on a b)",
        "wording": "usual",
        "question": "Is a on b?",
        "repeat": 0,
        "truth": True,
        "reply": Reply.YES,
        "p_yes": None,
        "source": "",
        "seconds": 0.0,
        "text": "",
    }
    return Row(**known | told)


answers = st.lists(
    st.builds(
        row,
        cluster=st.sampled_from("abcdefgh"),
        truth=st.booleans(),
        reply=st.sampled_from(list(Reply)),
        p_yes=st.none() | st.floats(0, 1),
        seconds=st.floats(0, 10),
    ),
    min_size=1,
    max_size=60,
)


@settings(max_examples=60)
@given(answers)
def test_figures_are_those_of_other_tools(rows: Sequence[Row]) -> None:
    found = score(rows)
    known = measure(Scored(each.reply, each.truth, each.p_yes) for each in rows)
    for name in ("accuracy", "balanced_accuracy", "auroc", "calibration_error", "abstained"):
        assert getattr(found, name).value == pytest.approx(getattr(known, name)), name
    told = [each for each in rows if each.p_yes is not None]
    if told:
        loss = sklearn_metrics.log_loss(
            [each.truth for each in told],
            np.clip([each.p_yes for each in told], 1e-4, 1 - 1e-4),
            labels=[False, True],
        )
        assert found.log_loss.value == pytest.approx(loss)
        p, truth = (np.array(column) for column in zip(*((e.p_yes, e.truth) for e in told)))  # noqa: B905
        assert found.calibration_error.value == pytest.approx(
            calibration_error(p.astype(float), truth.astype(bool))
        )
    for name in ("accuracy", "when_answered", "auroc", "log_loss", "abstained"):
        each = getattr(found, name)
        if each.low is not None:
            assert each.low <= each.high


def drawn(seed: int, *, clusters: int = 40, rate: float = 0.8, share: float = 0.0) -> list[Row]:
    """Answers of which a share is the scene's own, to four questions in five pictures of each."""
    draws = random.Random(seed)
    rows = []
    for cluster in range(clusters):
        for question in range(4):
            truth, own = draws.random() < 0.5, draws.random() < rate
            for look in range(5):
                right = own if draws.random() < share else draws.random() < rate
                reply = Reply.YES if right is truth else Reply.NO
                told: dict[str, Any] = {
                    "cluster": str(cluster),
                    "scene": str(cluster),
                    "truth": truth,
                    "fact": str(question),
                }
                told |= {"question": str(question), "look": f"{cluster}/{look}"}
                rows.append(row(**told, reply=reply))
    return rows


@pytest.mark.parametrize("share", [0.0, 0.5, 0.9])
def test_the_lasting_share_is_found(share: float) -> None:
    found = lasting_errors(drawn(1, share=share, clusters=150))
    assert found.share is not None
    assert found.low is not None
    assert found.high is not None
    assert found.share == pytest.approx(share, abs=0.15 if not share else 0.07)
    assert found.low <= max(share, found.low) <= found.high
    assert found.pairs == 150 * 4 * 10
    assert found.same_picture is None


def test_asked_again_about_one_picture_is_told_apart_from_other_pictures() -> None:
    rows = [
        row(cluster=str(k), scene=str(k), look=f"{k}", repeat=repeat, truth=True, reply=reply)
        for k in range(40)
        for reply in [Reply.YES if k % 3 else Reply.NO]
        for repeat in range(3)
    ]
    found = lasting_errors(rows)
    assert found.share is None
    assert (found.pairs, found.same_picture_pairs) == (0, 40 * 3)
    assert found.same_picture == pytest.approx(1)


def test_intervals_hold_what_is_true_as_often_as_they_say() -> None:
    """Whole clusters are drawn: answers that hang together make an interval wide."""
    inside = []
    for seed in range(100):
        found = score(drawn(seed, share=1.0), seed=seed).accuracy
        assert found.low is not None
        assert found.high is not None
        inside.append(found.low <= 0.8 <= found.high)
    assert 0.86 <= np.mean(inside) <= 1


def test_of_few_clusters_nothing_is_promised() -> None:
    assert score(drawn(1, clusters=5)).accuracy.low is None
    assert lasting_errors(drawn(1, clusters=5)).low is None


def test_who_is_asked_the_same_is_compared_in_pairs() -> None:
    rows = drawn(3)
    worse = [row(**{**each.plain(), "reply": Reply.UNKNOWN, "way": each.way}) for each in rows[::2]]
    found = difference(rows, worse, ("one", "two"))
    assert found is not None
    assert found.pairs <= len(worse)
    assert found.accuracy.value == pytest.approx(0.8, abs=0.1)
    assert found.accuracy.low is not None
    assert found.accuracy.low > 0.5
    same = difference(rows, rows, ("one", "one"))
    assert same is not None
    assert (same.accuracy.low, same.accuracy.high) == (0, 0)
    assert difference(rows, [], ("one", "none")) is None


LOOKING = """
from tpvqa.vlm import Answer, Reply
from tpvqa.vlm.capabilities import Deterministic, NeedsPictures

class Bright(NeedsPictures, Deterministic):
    '''Sees which half is white; of words it knows "lit" alone. Ends after so many looks.'''
    left = None
    asked = 0
    def __init__(self, name):
        self.name = name
    @classmethod
    def from_spec(cls, arguments):
        return cls(f"bright:{arguments}" if arguments else "bright")
    def ask(self, observation, questions):
        type(self).asked += len(questions)
        if self.left is not None:
            if not self.left:
                raise KeyboardInterrupt
            type(self).left -= 1
        pixels = observation.frames["front"].pixels
        found = []
        for each in questions:
            half = pixels[:7, :4] if "left" in each.text else pixels[:7, 4:]
            if "lit" not in each.text:
                found.append(Answer(each, Reply.UNKNOWN, text="no such \\x1b[1mword"))
                continue
            p = float((half > 128).mean())
            found.append(Answer(each, Reply.YES if p > 0.5 else Reply.NO, p_yes=p, source="light"))
        return found
"""


@pytest.fixture
def lamps(tmp_path: Path, install: Install) -> tuple[object, ...]:
    install("bright", LOOKING, "bright = bright:Bright")
    folder = make_set(tmp_path / "lamps")
    return ("--pictures", folder, "--domain", DOMAIN, "--problem", PROBLEM)


def test_vlms_are_compared_on_pictures(tpvqa: Run, lamps: tuple[object, ...]) -> None:  # noqa: F811
    words = ("vlm", "compare", "bright", "oracle:0.6", *lamps, "--price", "bright=0.5", "--seed", 2)
    code, out, _ = tpvqa(*words)
    assert code == 0
    assert "oracle:0.6 less bright" in out
    before = Path("vlm-compare/answers.csv").read_bytes()
    code, _, err = tpvqa(*words, "--seed", 3)
    assert (code, "answers.csv is there" in err, "--force" in err) == (2, True, True)
    assert Path("vlm-compare/answers.csv").read_bytes() == before
    found = json.loads(tpvqa(*words, "--json", "--force")[1])
    bright, oracle = found["vlms"]
    assert bright["score"]["when_answered"]["value"] == 1
    assert bright["price"] == 0.5
    assert oracle["price"] is None
    assert oracle["score"]["accuracy"]["value"] < 1
    with Path("vlm-compare/answers.csv").open(newline="") as file:
        rows = [each for each in csv.DictReader(file) if each["vlm"] == "bright"]
    assert len(rows) == bright["score"]["answers"]
    answered = [each for each in rows if each["reply"] != "unknown"]
    assert all((each["reply"] == "yes") == (each["truth"] == "True") for each in answered)
    unknown = {each["text"] for each in rows if each["reply"] == "unknown"}
    assert unknown == {r"no such \x1b[1mword"}
    follows = [each["truth"] for each in rows if each["predicate"] == "bright"]
    assert follows == ["True"]  # by an axiom: the manifest does not say it
    assert Path("vlm-compare/compare.png").read_bytes().startswith(b"\x89PNG")
    assert Path("vlm-compare/compare.svg").read_text().startswith("<?xml")


def test_what_was_interrupted_goes_on_and_nothing_is_asked_twice(
    tpvqa: Run,  # noqa: F811
    lamps: tuple[object, ...],
) -> None:
    words = ("vlm", "compare", "bright", *lamps, "--cache", "a.db", "--json")
    tpvqa("vlm", "compare", "oracle", *lamps)  # the VLM of the set is imported by now, or here:
    from importlib import import_module

    bright = import_module("bright").Bright
    bright.left = 3
    code, _, err = tpvqa(*words, "--out", "new")
    assert code == 130
    assert "the same command goes on" in err
    assert not Path("new").exists()
    asked, bright.left, bright.asked = bright.asked, None, 0
    assert 0 < stats(Path("a.db")).answers < asked
    code, out, _ = tpvqa(*words, "--force")
    assert code == 0
    assert bright.asked < json.loads(out)["vlms"][0]["score"]["answers"]
    bright.asked = 0
    assert tpvqa(*words[:-3], "--replay", "a.db", "--json", "--force")[1] == out
    assert bright.asked == 0


def test_a_comparison_takes_the_place_of_no_link(
    tpvqa: Run,  # noqa: F811
    lamps: tuple[object, ...],
) -> None:
    Path("new").mkdir()
    Path("new/answers.csv").symlink_to("elsewhere.csv")
    code, _, err = tpvqa("vlm", "compare", "oracle", *lamps, "--out", "new")
    assert (code, "answers.csv is a link" in err) == (2, True), err
    assert Path("new/answers.csv").is_symlink()


def test_what_cannot_be_written_over_is_told_before_anything_is_asked(
    tpvqa: Run,  # noqa: F811
    lamps: tuple[object, ...],
) -> None:
    Path("new/figures.csv").mkdir(parents=True)
    words = ("vlm", "compare", "oracle", *lamps, "--out", "new", "--cache", "a.db", "--force")
    code, _, err = tpvqa(*words)
    assert (code, "figures.csv is no file" in err) == (2, True), err
    assert not Path("a.db").exists()


def test_wordings_are_compared_in_pairs(
    tpvqa: Run,  # noqa: F811
    lamps: tuple[object, ...],
    tmp_path: Path,
) -> None:
    other = tmp_path / "shining.yaml"
    other.write_text(
        QUESTIONS.read_text().replace("lit", "shining").replace("  shining:", "  lit:")
    )
    code, out, _ = tpvqa(
        *("vlm", "compare", "bright", *lamps, "--json"),
        *("--questions", QUESTIONS, "--questions", other),
    )
    assert code == 0
    lines = {(each["predicate"], each["wording"]): each for each in json.loads(out)["wordings"]}
    assert lines["lit", "shining"]["difference"]["accuracy"]["value"] == -1
    assert lines["lit", "questions"]["score"]["accuracy"]["value"] == 1
    assert {lines["lit", name]["verdict"] for name in ("questions", "shining")} == {"not known"}


def test_of_few_groups_no_wording_is_said_to_be_among_the_best(
    tpvqa: Run,  # noqa: F811
    lamps: tuple[object, ...],
    tmp_path: Path,
) -> None:
    other = tmp_path / "shining.yaml"
    other.write_text(
        QUESTIONS.read_text().replace("lit", "shining").replace("  shining:", "  lit:")
    )
    words = ("vlm", "compare", "bright", *lamps, "--questions", QUESTIONS, "--questions", other)
    said = " ".join(tpvqa(*words)[1].split())
    assert "among the best" not in said
    assert "groups of looks that hang together (pictures that show the same facts" in said
    assert "which wording is best is not known where there are fewer than 6 groups" in said
    drawn = Path("vlm-compare/compare.svg").read_text()
    assert "bright, questions" in drawn  # each wording by itself
    assert "bright, shining" in drawn


def worded(*, right: dict[str, float], clusters: int) -> list[Row]:
    """Two questions about each scene in each wording, right so often."""
    return [
        row(
            cluster=str(k),
            scene=str(k),
            look=str(k),
            fact=f"(on a b{truth})",
            wording=wording,
            question=f"{wording} {truth}?",
            truth=truth,
            reply=Reply.YES if truth is (k < rate * clusters) else Reply.NO,
        )
        for wording, rate in right.items()
        for k in range(clusters)
        for truth in (True, False)
    ]


@pytest.mark.parametrize(
    ("clusters", "right", "verdicts"),
    [
        (40, {"one": 0.95, "two": 0.1}, ["best", ""]),
        (40, {"one": 0.95, "two": 0.95}, ["among the best", "among the best"]),
        (5, {"one": 1.0, "two": 0.0}, ["not known", "not known"]),
    ],
)
def test_the_verdict_on_a_wording_needs_an_interval(
    clusters: int, right: dict[str, float], verdicts: list[str]
) -> None:
    found = compare(worded(right=right, clusters=clusters), "scenes")
    assert [each.verdict for each in found.wordings if each.predicate is None] == verdicts


@pytest.mark.parametrize(
    ("vlm", "why"),
    [
        ("oracle", "pairs of answers about other pictures of one scene there is no error"),
        ("oracle:0", "a predicate's errors are all or none"),
    ],
)
def test_why_nothing_is_known_of_errors_that_last_is_the_true_reason(
    tpvqa: Run,  # noqa: F811
    lamps: tuple[object, ...],
    vlm: str,
    why: str,
) -> None:
    code, out, err = tpvqa("vlm", "compare", vlm, *lamps)
    assert code == 0, err
    assert why in " ".join(out.split())


def test_where_no_scene_was_answered_twice_that_is_said(
    tpvqa: Run,  # noqa: F811
    lamps: tuple[object, ...],
) -> None:
    edit(Path(str(lamps[1])), without("both2.jpg"))
    _, out, err = tpvqa("vlm", "compare", "oracle", *lamps)
    assert "no question was answered of two pictures of one scene" in " ".join(out.split()), err


def test_wordings_of_one_file_are_compared_too(
    tpvqa: Run,  # noqa: F811
    lamps: tuple[object, ...],
    tmp_path: Path,
) -> None:
    both = tmp_path / "both.yaml"
    first = next(line for line in QUESTIONS.read_text().splitlines() if line.startswith("  lit:"))
    said = first.partition(": ")[2]
    both.write_text(
        QUESTIONS.read_text().replace(said, f"[{said}, {said.replace('lit', 'shining')}]", 1)
    )
    code, out, _ = tpvqa("vlm", "compare", "bright", *lamps, "--json", "--questions", both)
    assert code == 0
    lines = {(each["predicate"], each["wording"]): each for each in json.loads(out)["wordings"]}
    assert lines["lit", "both, wording 2"]["difference"]["accuracy"]["value"] == -1
    assert lines["lit", "both"]["score"]["accuracy"]["value"] == 1


def test_episodes_are_asked_again(tpvqa: Run) -> None:  # noqa: F811
    tpvqa("run", "eat_apple", "--seed", 7, "--out", "one", "--vlm", "embedded")
    told = [
        (each["text"], answer["reply"])
        for line in map(json.loads, Path("one/episode.jsonl").read_text().splitlines())
        if line["kind"] in ("asked", "answered")
        for each, answer in zip(line.get("questions", ()), line.get("answers", ()), strict=False)
    ]
    assert not told  # questions and answers stand in two lines
    code, out, _ = tpvqa("vlm", "compare", "embedded", "oracle", "--episodes", "one", "--json")
    assert code == 0
    embedded, oracle = json.loads(out)["vlms"]
    assert oracle["score"]["accuracy"]["value"] == 1
    assert embedded["score"]["answers"] == oracle["score"]["answers"] > 0
    copytree("one", "copy")
    code, _, err = tpvqa("vlm", "compare", "oracle", "--episodes", "one", "--episodes", "copy")
    assert code == 2
    assert "is a copy of" in err


@pytest.mark.parametrize(
    ("words", "why"),
    [
        ((), "Give one labelled set"),
        (("--pictures", "none"), "none"),
        (("--pictures", "shipped", "--price", "other=1"), "none of these VLMs"),
        (("--pictures", "shipped", "--price", "embedded"), "VLM=AMOUNT"),
        (("--pictures", "shipped", "--option", "x=1"), "x"),
        (("--episodes", "none"), "none"),
    ],
)
def test_what_cannot_be_compared_is_told(tpvqa: Run, words: tuple[str, ...], why: str) -> None:  # noqa: F811
    code, _, err = tpvqa("vlm", "compare", "embedded", *words)
    assert code == 2
    assert why in err


def test_what_fails_leaves_no_folder(tpvqa: Run, lamps: tuple[object, ...]) -> None:  # noqa: F811
    assert tpvqa("vlm", "compare", "bright", *lamps, "--replay", "none.db")[0] == 2
    assert not Path("vlm-compare").exists()


def test_a_vlm_that_is_named_twice_is_told(tpvqa: Run, lamps: tuple[object, ...]) -> None:  # noqa: F811
    code, _, err = tpvqa("vlm", "compare", "oracle:0.8", "oracle:0.8", *lamps)
    assert code == 0
    assert "is named 2 times, and asked once" in err
