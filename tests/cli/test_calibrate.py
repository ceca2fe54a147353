"""`tpvqa calibrate`, as a user types it."""

import json
import re
import shutil
from itertools import pairwise
from pathlib import Path

import pytest
from PIL import Image

from tests.cli.conftest import Run
from tests.episodes.test_log import file_size
from tpvqa.belief import Calibration, Group
from tpvqa.belief.learning.chances import Chances
from tpvqa.belief.learning.experience import Experience
from tpvqa.episodes import read_episode
from tpvqa.episodes.log import LOG
from tpvqa.episodes.own_files import LABELS
from tpvqa.events.events import Acted
from tpvqa.questions import Way
from tpvqa.worlds.outcome import Failure
from tpvqa.worlds.pictures import MANIFEST
from tpvqa_household.images.manifest import load_pictures

TOYS = Path(__file__).parents[1] / "fixtures" / "toys"
TRIALS = ["--trials", "10", "--tasks", "clean_dishes", "--vlm", "oracle:0.9:0.4"]


def test_from_trials(tpvqa: Run) -> None:
    code, out, err = tpvqa("calibrate", *TRIALS, "--monitor", "tpvqa:3", "--out", "made/c.json")
    assert code == 0, err
    assert Calibration.load(Path("made/c.json")).vlm == "oracle:0.9:0.4"
    assert "ECE before → after" in out
    assert "effect        clean" in out
    assert "from the same view" in out
    rows = Calibration.load(Path("made/c.json")).rows
    assert f" of {rows} answers, the first to the same words" in out
    assert "wrote made/c.json and made/c.png" in out
    assert "trials" in err
    with Image.open("made/c.png") as picture:
        assert picture.width > 1000
        assert len(picture.convert("RGB").getcolors(1 << 20) or ()) > 100


def test_from_trials_of_tasks_of_ones_own(tpvqa: Run) -> None:
    own = ["--domain", TOYS / "domain.pddl", "--problem", TOYS / "collect.pddl"]
    words = ["--questions", TOYS / "questions.yaml", "--trials", 4, "--vlm", "oracle:0.9"]
    code, out, err = tpvqa("calibrate", *own, *words)
    assert code == 0, err
    assert "pick_up" not in out.partition("failed, where")[0]  # facts are asked about
    assert "found" in out
    assert Calibration.load(Path("calibration.json")).vlm == "oracle:0.9"
    code, _, err = tpvqa("calibrate", *own, "--world-file", "none.yaml", *words, "--force")
    assert code == 2
    assert "none.yaml" in err


def test_from_trials_of_a_logic_program(tpvqa: Run) -> None:
    program = Path(__file__).parents[2] / "examples" / "programs" / "clean_dishes.lp"
    for option in ("--domain", "--problem"):
        words = [option, program, "--trials", 4, "--vlm", "oracle:0.9", "--out", f"{option}.json"]
        code, out, err = tpvqa("calibrate", *words)
        assert code == 0, err
        assert "effect        clean" in out


def test_json_has_the_promised_fields(tpvqa: Run) -> None:
    code, out, _ = tpvqa("calibrate", *TRIALS, "--json", "--curves", "seen.svg")
    found = json.loads(out)
    assert code == 0
    assert (found["vlm"], found["file"], found["curves"]) == (
        "oracle:0.9:0.4",
        "calibration.json",
        "seen.svg",
    )
    assert Path("seen.svg").read_text().lstrip().startswith("<?xml")
    assert found["repeat_same_view"] == Calibration.load(Path(found["file"])).repeat_same_view
    last = found["lines"][-1]
    assert (last["way"], last["predicate"]) == (None, None)
    assert last["answers"] == sum(line["answers"] for line in found["lines"][:-1])
    assert 0 <= last["error_after"] < 0.15


def test_from_recorded_episodes(tpvqa: Run) -> None:
    words = ["--world", "symbolic", "--vlm", "oracle:0.8", "--monitor", "effectvqa"]
    for seed in (1, 2):
        tpvqa("run", "eat_apple", *words, "--seed", seed, "--out", f"e{seed}")
    code, out, err = tpvqa("calibrate", "e1", "e2/episode.jsonl")
    assert code == 0, err
    assert "oracle:0.8" in out
    assert Calibration.load(Path("calibration.json")).rows > 10
    code, _, err = tpvqa("calibrate", "e1", "--vlm", "embedded", "--force")
    assert code == 2
    assert "oracle:0.8 answered in it, not embedded" in err


def test_labels_that_all_say_the_same_are_told_and_kept(tpvqa: Run) -> None:
    words = ["--world", "symbolic", "--vlm", "oracle:0.8", "--monitor", "effectvqa"]
    tpvqa("run", "eat_apple", *words, "--failure", 0, "--out", "e1")
    code, out, err = tpvqa("calibrate", "e1")
    assert code == 0, err
    assert re.search(r"no label says (yes|no) of .* Next, label looks", out.replace("\n", " "))
    assert any(
        each.startswith("no label says")
        for each in Calibration.load(Path("calibration.json")).notices
    )


def test_recorded_episodes_say_how_often_actions_fail(tpvqa: Run) -> None:
    words = ["--world", "symbolic", "--vlm", "oracle", "--monitor", "tpvqa", "--failure", 0.6]
    for seed in range(4):
        tpvqa("run", "clean_dishes", *words, "--seed", seed, "--out", f"e{seed}")
    folders = [f"e{seed}" for seed in range(4)]
    code, _, err = tpvqa("calibrate", *folders, "--experience", "known.json")
    assert code == 0, err
    known = Experience.load(Path("known.json"))
    assert known is not None
    assert known.trials == 4
    failures, successes = known.failure[0] - 3, known.failure[1] - 9
    told = [
        event.truth.failure
        for folder in folders
        for event in read_episode(folder)
        if isinstance(event, Acted) and event.truth is not None
    ]
    assert failures == told.count(Failure.CHANCE)
    assert 0.35 < failures / (failures + successes) < 0.8
    code, _, err = tpvqa("calibrate", "--trials", 2, "--experience", "known.json")
    assert code == 2
    assert "name their folders" in err


def test_from_a_folder_of_pictures(tpvqa: Run, tmp_path: Path) -> None:
    shipped = load_pictures()
    few = shipped.manifest.pictures[::60]
    (tmp_path / "set").mkdir()
    for picture in few:
        shutil.copy(shipped.folder / picture.file, tmp_path / "set")
    manifest = shipped.manifest.model_copy(update={"pictures": few})
    (tmp_path / "set" / MANIFEST).write_text(manifest.model_dump_json())
    code, out, err = tpvqa("calibrate", "--pictures", "set", "--out", "c.json")
    assert code == 0, err
    assert "precondition  near" in out
    assert Calibration.load(Path("c.json")).vlm == "embedded"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], ["one source", "--pictures", "--trials", "none was given"]),
        (["--trials", "2", "--pictures", "shipped"], ["one source", "several"]),
        (["e", "--trials", "2"], ["several"]),
        (["--pictures", "nowhere"], ["nowhere", "set of pictures"]),
        (["--trials", "2", "--domain", "d.pddl"], ["--domain and --problem", "--pictures"]),
        (["nowhere"], ["nowhere holds no episode"]),
        (["--pictures", "shipped", "--vlm", "oracle"], ["noise model"]),
        (["--trials", "1", "--tasks", "eat_aple"], ["eat_aple", "Did you mean"]),
        (["--trials", "1", "--tasks", ","], ["--tasks names no task"]),
        (["--trials", "1", "--monitor", "tp"], ["no yes or no"]),
        (["--trials", "1", "--vlm", "oracle", "--monitor", ""], ["monitor"]),
        (["--trials", "0"], ["--trials"]),
    ],
)
def test_bad_input_says_what_to_do(tpvqa: Run, words: list[str], said: list[str]) -> None:
    code, _, err = tpvqa("calibrate", *words)
    assert code == 2
    for word in said:
        assert word in err
    assert not Path("calibration.json").exists()


def test_a_file_that_cannot_be_written_is_told_before_the_work(tpvqa: Run, tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    code, _, err = tpvqa("calibrate", *TRIALS, "--out", "folder")
    assert code == 2
    assert "folder" in err
    assert "--out" in err
    assert "trials" not in err


def test_where_not_all_can_be_written_the_same_command_goes_again(tpvqa: Run) -> None:
    words = ("calibrate", "--trials", 4, "--tasks", "clean_dishes", "--vlm", "oracle:0.9")
    with file_size(20_000):
        code, _, err = tpvqa(*words, "--out", "c.json")
    assert (code, "c.png" in err) == (6, True), err
    assert [path.name for path in Path().glob("c.*")] == []
    assert tpvqa(*words, "--out", "c.json")[0] == 0
    assert Path("c.json").stat().st_size < 20_000 < Path("c.png").stat().st_size


def test_a_file_below_a_file_is_told_before_the_work(tpvqa: Run) -> None:
    Path("plain").touch()
    code, _, err = tpvqa("calibrate", *TRIALS, "--out", "plain/c.json")
    assert code == 6
    assert err.endswith(
        "plain/c.json: cannot be written (plain is no folder). Name another file with --out\n"
    )
    assert "trials" not in err


def test_trials_that_teach_are_run_under_the_conditions_given(tpvqa: Run) -> None:
    words = ("calibrate", "--tasks", "build_tower", "--vlm", "oracle:0.8", "--trials", 3, "--json")
    rows = []
    for name, more in (("usual", ()), ("short", ("--failure", 0.6, "--max-actions", 2))):
        code, out, err = tpvqa(*words, *more, "--out", f"{name}.json")
        assert code == 0, err
        rows.append(json.loads(out)["rows"])
    assert 0 < rows[1] < rows[0]
    code, _, err = tpvqa("calibrate", "--pictures", "shipped", "--failure", 0.6)
    assert code == 2
    assert "for --trials" in err


def test_a_file_that_is_there_is_written_over_by_force_alone(tpvqa: Run) -> None:
    Path("c.json").write_text("work")
    words = ("calibrate", *TRIALS, "--out", "c.json")
    code, _, err = tpvqa(*words)
    assert code == 2
    assert "c.json is there" in err
    assert "--force" in err
    assert Path("c.json").read_text() == "work"
    assert tpvqa(*words, "--force")[0] == 0


@pytest.mark.parametrize(
    ("words", "options"),
    [
        (("--out", "c.png"), ("--out", "--curves")),
        (("--out", "c.json", "--curves", "./c.json"), ("--out", "--curves")),
        (("--out", "c.json", "--experience", "c.json"), ("--out", "--experience")),
        (("--out", "c.json", "--experience", "c.png"), ("--curves", "--experience")),
    ],
)
def test_one_file_is_not_written_twice(
    tpvqa: Run, words: tuple[str, ...], options: tuple[str, str]
) -> None:
    code, _, err = tpvqa("calibrate", "nowhere", *words, "--force")
    assert code == 2
    assert f"{options[0]} and {options[1]} are the same file" in err


@pytest.mark.parametrize("there", ["c.png", "curves.svg", "e.json"])
def test_no_other_file_that_is_there_is_written_over(tpvqa: Run, there: str) -> None:
    Path(there).write_text("work")
    curves = () if there == "c.png" else ("--curves", "curves.svg")
    words = ("calibrate", "nowhere", "--out", "c.json", *curves, "--experience", "e.json")
    code, _, err = tpvqa(*words)
    assert code == 2
    assert f"{there} is there" in err
    assert Path(there).read_text() == "work"


def test_where_nothing_is_learnt_no_experience_is_written(tpvqa: Run) -> None:
    words = ("--monitor", "none", "--vlm", "oracle", "--world", "symbolic", "--out", "e")
    assert tpvqa("run", "build_tower", *words)[0] in (0, 1)
    code, _, err = tpvqa("calibrate", "e", "--experience", "e.json")
    assert code == 2
    assert "no yes or no" in err
    assert not Path("e.json").exists()


def test_a_calibration_that_is_none_is_called_what_it_is(tpvqa: Run) -> None:
    words = ("run", "build_tower", "--vlm", "oracle", "--world", "symbolic", "--calibration")
    Experience.of(Chances(), None, 1).save(Path("e.json"))
    code, _, err = tpvqa(*words, "e.json")
    assert code == 2
    assert "e.json: it is an experience, which --experience takes, and no calibration" in err
    group = Group(way=Way.EFFECT, predicate="on", rates=Calibration.default().whole.rates)
    doubled = Calibration.default("oracle").model_copy(update={"groups": (group, group)})
    doubled.save(Path("c.json"))
    code, _, err = tpvqa(*words, "c.json")
    assert code == 2
    assert "c.json: it tells of on of effect twice" in err


def test_a_set_without_pictures_says_so(tpvqa: Run, tmp_path: Path) -> None:
    (tmp_path / "set").mkdir()
    (tmp_path / "set" / MANIFEST).write_text('{"domain": "household", "pictures": []}')
    code, _, err = tpvqa("calibrate", "--pictures", "set")
    assert code == 2
    assert "the set has no pictures" in err


@pytest.mark.parametrize("out", ["e/episode.jsonl", "e/labels.jsonl", "e/frames/one.json"])
@pytest.mark.parametrize("option", ["--out", "--experience", "--curves"])
def test_what_is_read_is_not_written_over_by_force_either(
    tpvqa: Run, option: str, out: str
) -> None:
    Path("e/frames").mkdir(parents=True)
    for name in (LOG, LABELS):
        Path("e", name).write_text("work")
    code, _, err = tpvqa("calibrate", "e", option, out, "--force")
    assert code == 2
    assert (
        err == f"error: {out} is read by this command, and would be lost; name another file "
        f"with {option}\n"
    )
    assert {file.read_text() for file in Path("e").glob("*.jsonl")} == {"work"}


def test_no_problem_of_a_folder_is_written_over(tpvqa: Run) -> None:
    shutil.copytree(TOYS, "toys")
    own = ("--domain", "toys/domain.pddl", "--problem", "toys", "--trials", 1)
    code, _, err = tpvqa("calibrate", *own, "--out", "toys/collect.pddl", "--force")
    assert (code, "toys/collect.pddl is read by this command" in err) == (2, True), err
    assert Path("toys/collect.pddl").read_bytes() == (TOYS / "collect.pddl").read_bytes()


def test_no_picture_of_the_set_that_teaches_is_written_over(tpvqa: Run, tmp_path: Path) -> None:
    shipped = load_pictures()
    shutil.copytree(shipped.folder, "set")
    words = ("calibrate", "--pictures", "set", "--vlm", "oracle", "--out", f"set/{MANIFEST}")
    code, _, err = tpvqa(*words, "--curves", "c.png", "--force")
    assert (code, f"set/{MANIFEST} is read by this command" in err) == (2, True)
    assert Path("set", MANIFEST).read_bytes() == (shipped.folder / MANIFEST).read_bytes()


def test_a_noise_model_is_surveyed_so_that_a_weak_one_teaches_of_late_steps_too(tpvqa: Run) -> None:
    """`tpvqa` stops early where answers are worth little, and then nothing is known of the rest."""
    hospital = Path(__file__).parents[2] / "examples" / "hospital"
    own = ("--domain", hospital / "domain.pddl", "--problem", hospital / "problem.pddl")
    shown = {}
    for name, who in (("survey", ()), ("tpvqa", ("--monitor", "tpvqa"))):
        words = ("calibrate", *own, "--trials", 10, "--vlm", "oracle:0.55", *who)
        code, _, err = tpvqa(*words, "--out", f"{name}.json")
        assert code == 0, err
        faults = Calibration.load(Path(f"{name}.json")).faults
        assert faults is not None
        shown[name] = set(faults.skills)
    assert shown["tpvqa"] < shown["survey"] > {"hand_over", "throw_away"}


@pytest.mark.parametrize(("who", "surveys"), [((), False), (("--monitor", "tpvqa"), True)])
def test_what_trials_did_not_show_takes_more_of_them(
    tpvqa: Run, who: tuple[str, ...], surveys: bool
) -> None:
    words = ("calibrate", "--trials", 1, "--tasks", "serve_breakfast", "--vlm", "oracle", *who)
    code, out, err = tpvqa(*words)
    assert code == 0, err
    told = " ".join(out.split())
    assert "right is not known. Run more trials" in told
    assert ("or --monitor survey:3, which goes on" in told) == surveys


def test_a_survey_of_a_long_plan_comes_to_its_end(tpvqa: Run) -> None:
    """Of forty steps, done twice, other trials that teach come to the thirtieth."""
    places = [f"p{number}" for number in range(41)]
    Path("domain.pddl").write_text(
        "(define (domain walk) (:requirements :strips) (:predicates (at ?p) (next ?p ?q))\n"
        "(:action step :parameters (?p ?q) :precondition (and (at ?p) (next ?p ?q))\n"
        ":effect (and (at ?q) (not (at ?p)))))"
    )
    roads = " ".join(f"(next {one} {other})" for one, other in pairwise(places))
    Path("problem.pddl").write_text(
        f"(define (problem far) (:domain walk) (:objects {' '.join(places)})\n"
        f"(:init (at p0) {roads}) (:goal (at p40)))"
    )
    Path("questions.yaml").write_text("predicates: {at: 'Is the robot at {p}?'}\n")
    own = ("--domain", "domain.pddl", "--problem", "problem.pddl")
    code, _, err = tpvqa("calibrate", *own, "--trials", 1, "--vlm", "oracle", "--failure", 0)
    assert code == 0, err
    faults = Calibration.load(Path("calibration.json")).faults
    assert faults is not None
    assert faults.skills["step"].worked == 40
