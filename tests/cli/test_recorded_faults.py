"""What recorded episodes tell of faults: losses after a success, and by doing a thing again."""

from pathlib import Path

from tests.cli.conftest import Run
from tpvqa.belief.learning.experience import Experience
from tpvqa.bench.labelled_episodes import label_episodes
from tpvqa.bench.recorded_faults import experience_from
from tpvqa.labelling import LABELS

QUIET = ("--world", "symbolic", "--vlm", "oracle", "--monitor", "tpvqa", "--failure", 0)


def test_what_worked_loose_in_recorded_episodes_is_counted(tpvqa: Run, tmp_path: Path) -> None:
    for name, rate in (("firm", 0), ("loose", 0.5)):
        for seed in (1, 2):
            out = f"{name}{seed}"
            tpvqa("run", "eat_apple", *QUIET, "--spontaneous", rate, "--seed", seed, "--out", out)
    told = {
        name: experience_from(
            label_episodes([tmp_path / f"{name}{seed}" for seed in (1, 2)]).own.acts
        )
        .chances()
        .rates
        for name in ("firm", "loose")
    }
    assert told["firm"].spontaneous < 0.01 < 0.1 < told["loose"].spontaneous


def test_what_doing_again_undoes_is_counted(tpvqa: Run, tmp_path: Path) -> None:
    """Who misreads repeats what is done: it comes undone where that is risky."""
    told = {}
    for redo in ("free", "risky"):
        faults = "--failure", 0.5, "--disturbance", 0.9, "--redo", redo
        words = "--world", "symbolic", "--vlm", "oracle:0.6", "--monitor", "tpvqa", *faults
        folders = []
        for seed in (1, 2, 3):
            tpvqa("run", "eat_apple", *words, "--seed", seed, "--out", f"{redo}{seed}")
            folders.append(f"{redo}{seed}")
        code, _, err = tpvqa("calibrate", *folders, "--experience", f"{redo}.json", "--force")
        assert code == 0, err
        known = Experience.load(tmp_path / f"{redo}.json")
        assert known is not None
        told[redo] = known.chances().rates.redone
    assert told["free"] < 0.005 < 0.1 < told["risky"]


def test_what_was_counted_counts_beside_labels_of_a_person(tpvqa: Run, tmp_path: Path) -> None:
    """The log of a simulated world tells what came of actions, whoever labels its answers."""
    words = "--world", "symbolic", "--vlm", "oracle:0.8", "--monitor", "tpvqa"
    assert tpvqa("run", "eat_apple", *words, "--seed", 3, "--out", "e")[0] in (0, 1)
    before = label_episodes([tmp_path / "e"]).own.acts
    (tmp_path / "e" / LABELS).write_text("")
    assert before
    assert label_episodes([tmp_path / "e"]).own.acts == before


LAMPS = """(define (domain lamps) (:types lamp)
  (:predicates (lit ?l - lamp) (dark ?l - lamp))
  (:action light :parameters (?l - lamp) :precondition ()
    :effect (and (lit ?l) (not (dark ?l)))))"""
PROBLEM = """(define (problem three) (:domain lamps) (:objects a b c - lamp)
  (:init (dark a) (dark b) (dark c)) (:goal (and (lit a) (lit b) (lit c))))"""


def test_what_people_move_is_not_counted(tpvqa: Run, tmp_path: Path) -> None:
    words = "--world", "symbolic", "--vlm", "oracle:0.6", "--monitor", "tpvqa", "--moved", 0.5
    for seed in (1, 2):
        tpvqa("run", "eat_apple", *words, "--seed", seed, "--out", f"m{seed}")
    assert tpvqa("calibrate", "m1", "m2", "--experience", "moved.json", "--force")[0] == 0
    known = Experience.load(tmp_path / "moved.json")
    assert known is not None
    assert known.chances().rates.redone <= 0.001


def test_what_doing_again_undoes_is_counted_without_a_world_file_too(
    tpvqa: Run, tmp_path: Path
) -> None:
    (tmp_path / "lamps.pddl").write_text(LAMPS)
    (tmp_path / "three.pddl").write_text(PROBLEM)
    own = "--domain", "lamps.pddl", "--problem", "three.pddl", "--failure", 0.5
    words = *own, "--disturbance", 1, "--redo", "risky", "--vlm", "oracle:0.6", "--monitor", "tpvqa"
    folders = []
    for seed in range(6):
        tpvqa("run", *words, "--seed", seed, "--out", f"l{seed}", "--max-actions", 40)
        folders.append(f"l{seed}")
    assert tpvqa("calibrate", *folders, "--experience", "lamps.json", "--force")[0] == 0
    known = Experience.load(tmp_path / "lamps.json")
    assert known is not None
    assert known.chances().rates.redone > 0.1
