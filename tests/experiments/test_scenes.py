"""The bench of scenes: recordings read, states weighed, tables of a folder made up here."""

import csv
import gzip
import json
import random
import sys
from collections import Counter
from collections.abc import Callable
from itertools import permutations
from pathlib import Path
from statistics import fmean
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tpvqa.cli import main
from tpvqa_experiments.scenes.arrangements import Shape, arrangements
from tpvqa_experiments.scenes.bench import first_looks, judge
from tpvqa_experiments.scenes.judged import Reading
from tpvqa_experiments.scenes.likelihood import Encoder, evidence, learn
from tpvqa_experiments.scenes.naive import learn_rates, naive_log_belief
from tpvqa_experiments.scenes.recorded import facts, read_scenes
from tpvqa_experiments.scenes.ridge import logistic
from tpvqa_experiments.scenes.situations import holds, looks
from tpvqa_experiments.scenes.weighing import Sample, Weighing, choose

Stacks = list[list[str]]
Command = Callable[..., tuple[int, str, str]]
SHAPES = [Shape(1, 1), Shape(2, 2), Shape(3, 2), Shape(3, 4)]


def answers_of(stacks: Stacks) -> dict[str, bool]:
    """Every fact of a scene, with whether it holds."""
    place = {block: (c, h) for c, stack in enumerate(stacks) for h, block in enumerate(stack)}
    found: dict[str, bool] = {}
    for x, (c, h) in place.items():
        found |= {f"on {x},{y}": place[y] == (c, h - 1) for y in place}
        found |= {f"incolumn {x},c{k + 1}": c == k for k in range(len(stacks))}
        found[f"clear {x}"] = h == len(stacks[c]) - 1
    found["leftof c1,c2"] = True
    return found


def write(folder: Path, scenes: list[dict[str, Any]], answers: list[tuple[Any, ...]]) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    names = [
        "scene",
        "environment",
        "setting",
        "split",
        "model",
        "problem",
        "run",
        "number",
        "step",
    ]
    for name, head, rows in (
        ("scenes", names, [[scene[n] for n in names] for scene in scenes]),
        ("answers", ["scene", "fact", "answer", "truth"], answers),
    ):
        with gzip.open(folder / f"{name}.csv.gz", "wt", newline="") as file:
            csv.writer(file).writerows([head, *rows])
    return folder


def made_up(folder: Path, *, wrong: float = 0.1, problems: int = 16, twice: bool = False) -> Path:
    """Two VLMs: one errs now and then, the other says that a block is on each below it."""
    rng = random.Random(3)
    scenes: list[dict[str, Any]] = []
    answers: list[tuple[Any, ...]] = []
    for problem in range(problems):
        stacks: Stacks = [[], []]
        for block in rng.sample("rgb", 3):
            rng.choice(stacks).append(block)
        for model in ("erring", "seeing-through"):
            for run in range(1 + twice):
                number = len(scenes)
                scenes.append(
                    {
                        "scene": number,
                        "environment": "blocksworld",
                        "setting": "no_cot",
                        "split": "simple",
                        "model": model,
                        "problem": f"p{problem}",
                        "run": run,
                        "number": 0,
                        "step": 0,
                    }
                )
                below = {
                    f"on {x},{y}"
                    for stack in stacks
                    for h, x in enumerate(stack)
                    for y in stack[:h]
                }
                for fact, true in answers_of(stacks).items():
                    said = true != (rng.random() < wrong)
                    if model == "seeing-through":
                        said = true or fact in below
                    answers.append((number, fact, "yes" if said else "no", int(true)))
    return write(folder, scenes, answers)


@pytest.fixture
def tpvqa(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Command:
    """Run the command: its exit code, stdout and stderr."""

    def run(*words: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["tpvqa", *map(str, words)])
        try:
            main()
        except SystemExit as end:
            return int(end.code or 0), *capsys.readouterr()
        return 0, *capsys.readouterr()

    return run


@pytest.mark.parametrize("shape", SHAPES)
def test_every_arrangement_is_there_once_and_is_one(shape: Shape) -> None:
    every = arrangements(shape)
    rows = np.concatenate([every.column, every.height], axis=1)
    assert len(rows) == shape.arrangements == len(np.unique(rows, axis=0))
    for column, height, stack in zip(every.column, every.height, every.stack, strict=True):
        assert Counter(column.tolist()) == {c: n for c, n in enumerate(stack.tolist()) if n}
        places = sorted(zip(column.tolist(), height.tolist(), strict=True))
        assert places == [(c, h) for c, tall in enumerate(stack.tolist()) for h in range(tall)]


def test_a_block_at_a_time_put_into_a_column_at_random_gives_the_prior() -> None:
    every = arrangements(Shape(3, 2))
    counted: Counter[int] = Counter()
    for columns in np.ndindex(2, 2, 2):
        for order in permutations(range(3)):
            height, tall = np.zeros(3, np.int8), [0, 0]
            for block in order:
                height[block] = tall[columns[block]]
                tall[columns[block]] += 1
            counted[every.place(np.array(columns, np.int8), height)] += 1
    found = np.exp(every.log_prior())
    assert found == pytest.approx([counted[k] / 48 for k in range(len(found))])


@pytest.mark.parametrize("shape", SHAPES)
def test_a_fact_holds_in_a_situation_where_it_does_in_the_arrangement(shape: Shape) -> None:
    every = arrangements(shape)
    for look in looks(shape):
        told = np.array([holds(look.predicate, seen) for seen in look.situations])[look.of]
        own, height = every.column[:, look.first], every.height[:, look.first]
        if look.predicate == "on":
            below = every.column[:, look.second], every.height[:, look.second] + 1
            true = (own == below[0]) & (height == below[1])
        elif look.predicate == "incolumn":
            true = own == look.second
        else:
            true = every.stack[np.arange(len(own)), own] == height + 1
        assert (told == true).all()


def test_scenes_are_read_with_their_true_arrangement(tmp_path: Path) -> None:
    for scene in read_scenes(made_up(tmp_path)):
        situations = zip(looks(scene.shape), scene.answers, strict=True)
        right = [
            holds(look.predicate, look.situations[look.of[scene.truth]]) == (answer == 1)
            for look, answer in situations
        ]
        if scene.model == "erring" and scene.as_answered:
            assert all(right)  # that a block is on itself is asked, and no arrangement says it
        if scene.model == "seeing-through":
            assert scene.as_answered == all(right)


def test_an_abstention_is_neither_yes_nor_no(tmp_path: Path) -> None:
    folder = made_up(tmp_path / "all", wrong=0.0)
    with gzip.open(folder / "answers.csv.gz", "rt") as file:
        rows = [tuple(row) for row in csv.reader(file)][1:]
    with gzip.open(folder / "scenes.csv.gz", "rt") as file:
        listed = list(csv.DictReader(file))
    silent = [
        (scene, fact, "unknown" if fact.startswith("clear") else answer, truth)
        for scene, fact, answer, truth in rows
    ]
    scenes = read_scenes(folder)
    abstaining = read_scenes(write(tmp_path / "silent", listed, silent))
    assert not any(scene.as_answered for scene in abstaining)
    encoder = Encoder.of(scenes)
    weights, rates = learn(scenes, encoder), learn_rates(scenes)
    for scene in abstaining[:4]:
        assert [
            a
            for a, (name, *_) in zip(scene.answers, facts(scene.shape), strict=True)
            if name == "clear"
        ] == [-1] * 3
        assert not evidence(scene, encoder, weights)[2].any()
    assert {key[1] for key in learn_rates(abstaining)} == {key[1] for key in rates} - {"clear"}


@settings(max_examples=30, deadline=None)
@given(
    exponents=st.tuples(*[st.floats(0.05, 3)] * 3),
    share=st.floats(0, 0.9),
    dulled=st.floats(0, 1),
    seed=st.integers(0, 99),
)
def test_a_belief_sums_to_one_and_its_set_holds_what_it_says(
    exponents: tuple[float, ...], share: float, dulled: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    every = arrangements(Shape(3, 2))
    said = (-20 * rng.random((3, len(every.column)))).astype(np.float32)
    found = Weighing(exponents, share, dulled).log_belief(said, every.log_prior())
    belief = np.exp(found)
    assert belief.sum() == pytest.approx(1)
    for truth in range(len(belief)):
        reading = Reading.of(found, truth)
        ranked = np.sort(belief)[::-1]
        assert ranked[: reading.states].sum() >= 0.95 - 1e-9
        assert ranked[: reading.states - 1].sum() < 0.95
        assert reading.sure == pytest.approx(ranked[0])
        assert reading.within or belief[truth] <= ranked[reading.states - 1] + 1e-12
        assert reading.within or not reading.right


def test_weights_are_found_where_answers_are_far_from_what_is_expected() -> None:
    rng = np.random.default_rng(1)
    present = np.stack([rng.integers(0, 4, 5000), rng.integers(4, 30, 5000)], axis=1)
    yes = (rng.random(5000) < 0.1).astype(float)
    mean, width = np.full(30, 6.0), np.full(30, 3.0)
    found = logistic(present, yes, np.ones(5000), mean=mean, width=width)
    gradient = (found - mean) / width**2
    p = 1 / (1 + np.exp(-found[present].sum(axis=1)))
    np.add.at(gradient, present, (p - yes)[:, None])
    assert np.abs(gradient).max() < 0.01


def test_the_naive_belief_sums_to_one(tmp_path: Path) -> None:
    scenes = read_scenes(made_up(tmp_path))
    rates = learn_rates(scenes)
    for scene in scenes[:6]:
        assert np.exp(naive_log_belief(scene, rates)).sum() == pytest.approx(1)


def test_evidence_is_weighed_by_how_much_it_turned_out_to_say() -> None:
    rng = np.random.default_rng(0)
    log_prior = arrangements(Shape(3, 2)).log_prior()
    said = [np.log(rng.dirichlet(np.full(len(log_prior), 0.2)) + 1e-9) for _ in range(300)]
    truths = [int(rng.choice(len(log_prior), p=np.exp(each) / np.exp(each).sum())) for each in said]

    def samples(times: float) -> list[Sample]:
        return [
            Sample.of(
                np.stack([times * (each - log_prior), 0 * each, 0 * each]).astype(np.float32),
                log_prior,
                truth,
                rng,
            )
            for each, truth in zip(said, truths, strict=True)
        ]

    def gap(times: float, weighing: Weighing) -> float:
        """How much surer than right the first states are."""
        read = [
            Reading.of(weighing.log_belief(sample.evidence, log_prior), sample.truth)
            for sample in samples(times)
        ]
        return fmean(each.sure for each in read) - fmean(each.right for each in read)

    too_sure = Weighing((1.0, 1.0, 1.0), share=0.0)
    assert gap(3.0, too_sure) > 0.1
    assert abs(gap(3.0, choose(samples(3.0)))) < 0.05
    assert choose(samples(0.3)).exponents[0] > 2 > 0.7 > choose(samples(3.0)).exponents[0]


def test_systematic_errors_are_seen_through_where_rates_by_predicate_are_not(
    tmp_path: Path,
) -> None:
    scenes = read_scenes(made_up(tmp_path, problems=40))
    judged = [each for half in judge(scenes, 0, lambda done, total: None) for each in half.judged]
    assert len(judged) == len(first_looks(scenes)) == 80
    own = [each for each in judged if each.scene.model == "seeing-through"]
    assert all(each.belief.right for each in own)


def test_what_is_judged_teaches_nothing(tmp_path: Path) -> None:
    scenes = read_scenes(made_up(tmp_path))
    first, _ = judge(scenes, 0, lambda done, total: None)
    own = {each.scene.problem for each in first.judged}
    # The other half alone, with the judged half's answers turned round.
    turned = [
        scene
        if scene.problem not in own
        else type(scene)(
            **{
                **{n: getattr(scene, n) for n in scene.__slots__},
                "answers": (1 - scene.answers).astype(np.int8),
            }
        )
        for scene in scenes
    ]
    assert judge(turned, 0, lambda done, total: None)[0].weighing == first.weighing


def test_the_command_writes_the_table_and_the_figure(tmp_path: Path, tpvqa: Command) -> None:
    data = made_up(tmp_path / "data", twice=True)
    named = ["bench", "scenes", "--data", data, "--json", "--seed", 4, "--out"]
    code, told, _ = tpvqa(*named, tmp_path / "out")
    assert code == 0
    rows = json.loads(told)
    assert rows == json.loads((tmp_path / "out/scenes.json").read_text())
    (every,) = [row for row in rows if row["model"] == row["split"] == "all"]
    assert every["scenes"] == 32  # the second run saw the same pictures
    scenes = first_looks(read_scenes(data))
    assert every["as_answered"] == sum(scene.as_answered for scene in scenes) / 32
    assert {"environment", "naive", "belief", "calibration_error", "states", "within"} <= set(every)
    assert (tmp_path / "out/reliability.png").read_bytes().startswith(b"\x89PNG")
    assert "## Targets" in (tmp_path / "out/scenes.md").read_text()
    assert tpvqa(*named, tmp_path / "again")[0] == 0
    for name in ("scenes.md", "judged.json", "targets.json"):
        assert (tmp_path / "out" / name).read_bytes() == (tmp_path / "again" / name).read_bytes()


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ("no folder", "scenes.csv.gz is not there"),
        ("no answers", "answers.csv.gz is not there"),
        ("cut off", "damaged"),
        ("another table", "no column"),
        ("a fact less", "lacks clear"),
        ("no arrangement", "no arrangement"),
        ("another answer", "'maybe'"),
        ("few problems", "at least 12 are needed"),
    ],
)
def test_data_that_are_missing_or_damaged_are_told(
    tmp_path: Path, tpvqa: Command, change: str, told: str
) -> None:
    folder = tmp_path / "data"
    if change != "no folder":
        made_up(folder, problems=4 if change == "few problems" else 16)
    path = folder / "answers.csv.gz"
    if change == "no answers":
        path.unlink()
    elif change == "cut off":
        path.write_bytes(path.read_bytes()[:-200])
    elif change not in ("no folder", "few problems"):
        text = gzip.decompress(path.read_bytes()).decode().splitlines()
        if change == "another table":
            text[0] = "scene,fact,said,truth"
        elif change == "a fact less":
            text.remove(next(line for line in text if "clear" in line))
        elif change == "no arrangement":
            text = [line.replace(",0", ",1") if '0,"incolumn' in line else line for line in text]
        else:
            text[1] = text[1].replace("yes", "maybe").replace("no", "maybe")
        path.write_bytes(gzip.compress("\n".join(text).encode()))
    code, _, error = tpvqa("bench", "scenes", "--data", folder, "--out", tmp_path / "out")
    assert code == 2
    assert told in error
    assert "--data" in error
    assert not (tmp_path / "out").exists()


def test_a_model_that_nobody_recorded_is_told(tmp_path: Path, tpvqa: Command) -> None:
    named = ["bench", "scenes", "--data", made_up(tmp_path / "data")]
    code, _, error = tpvqa(*named, "--models", "ering", "--out", tmp_path / "out")
    assert code == 2
    assert "erring" in error
