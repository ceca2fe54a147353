"""A fact that no camera shows and the robot senses itself: whole trials, as a user runs them."""

import json
import re
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest

from tests.cli.conftest import Run
from tests.doubles import configured
from tests.resumed import resumed, story, unbroken
from tpvqa.assembly import Trial
from tpvqa.belief import Calibration
from tpvqa.episodes import EpisodeWriter, MemoryWriter, read_episode
from tpvqa.episodes.log import LOG
from tpvqa.errors import EpisodeError
from tpvqa.events import Decision, Ended, Event
from tpvqa.events.events import Acted, Acting, Asked, Decided, Observed
from tpvqa.planning import Planner
from tpvqa.planning.fast_downward import FastDownward
from tpvqa.planning.remembering import Remembering
from tpvqa.resuming import resume
from tpvqa.worlds.outcome import Failure

WARD = Path(__file__).parents[1] / "fixtures" / "drawers"
FILES = {name: str(WARD / f"{name}.pddl") for name in ("domain", "problem")}
WORDS = [word for name, file in FILES.items() for word in (f"--{name}", file)]
TRIAL = [*WORDS, "--world", "symbolic"]
NOTHING = "undo: []"


@pytest.fixture(scope="module")
def planner() -> Iterator[Planner]:
    planner = Remembering(FastDownward())
    yield planner
    planner.close()


def run(
    planner: Planner, monitor: str = "belief", *, rules: Path = WARD / "world.yaml", **more: object
) -> tuple[Ended, list[Event]]:
    """A trial with a VLM that is always right."""
    files = {**FILES, "questions": str(WARD / "questions.yaml"), "world_file": str(rules)}
    config = configured(**files, world="symbolic", vlm="oracle:1", monitor=monitor, **more)
    writer = MemoryWriter()
    with Trial(config, planner=planner) as trial:
        return trial.run(writer), writer.events


def disinfected(events: list[Event]) -> list[tuple[Acted, Decided]]:
    """What came of each disinfecting, and what was decided after it."""
    found, action, came = [], "", None
    for event in events:
        match event:
            case Acting():
                action = event.action.name
            case Acted():
                came = event
            case Decided(when="after") if action == "disinfect":
                assert came is not None
                found.append((came, event))
    return found


def late_successes(events: list[Event]) -> int:
    """How often something worked after five failures in a row, or more."""
    came = [e.truth.succeeded for e in events if isinstance(e, Acted) and e.truth]
    return sum(came[n] and not any(came[n - 5 : n]) for n in range(5, len(came)))


def test_what_failed_by_the_sensor_is_repeated_and_nothing_else(planner: Planner) -> None:
    decisions = []
    for seed in range(12):
        ended, events = run(planner, seed=seed)
        assert ended.completed
        assert not any("contaminated" in str(e.questions) for e in events if isinstance(e, Asked))
        for acted, decided in disinfected(events):
            (reading,) = acted.facts
            assert acted.truth is not None
            assert (reading.probability > 0.5) == (not acted.truth.succeeded)
            again = decided.decision is Decision.REPEAT
            shut = acted.truth.failure is Failure.PRECONDITION  # it had not been opened
            back = shut and decided.course == "go back"
            assert (again or back) == (reading.probability > 0.5), decided.reason
            assert "as sensed" in decided.reason
            decisions.append(again)
    assert {True, False} == set(decisions)


def test_where_nothing_fails_what_is_sensed_is_done_once(planner: Planner) -> None:
    for seed in range(4):
        ended, _ = run(planner, seed=seed, failure=0.0)
        assert (ended.completed, ended.actions) == (True, 6)


def test_what_the_robot_never_hears_of_it_does_not_tell(planner: Planner, tmp_path: Path) -> None:
    (tmp_path / "world.yaml").write_text(NOTHING)
    for seed in range(3):
        _, events = run(planner, rules=tmp_path / "world.yaml", seed=seed, limits={"actions": 12})
        assert not any(e.facts for e in events if isinstance(e, Acted | Observed))
        assert not any("sensed" in e.reason for e in events if isinstance(e, Decided))


@pytest.mark.parametrize("at", ["look", "effect", "action"])
def test_where_everything_is_sensed_no_question_is_needed(tpvqa: Run, at: str) -> None:
    """Nor more than one look, but where looks are what senses."""
    Path("felt.yaml").write_text(
        "undo: []\nsensed:\n"
        f"  - {{fact: '(contaminated ?d)', at: {at}}}\n  - {{fact: '(open ?d)', at: {at}}}"
    )
    Path("mute.yaml").write_text("never_asked: [{fact: '(contaminated ?d)'}, {fact: '(open ?d)'}]")
    given = ["--world-file", "felt.yaml", "--questions", "mute.yaml", "--vlm", "oracle:1"]
    for seed in (2, 3):
        code, _, err = tpvqa("run", *TRIAL, *given, "--seed", seed, "--out", f"e{seed}")
        assert code == 0, err
        events = read_episode(f"e{seed}")
        ended = events[-1]
        assert isinstance(ended, Ended)
        failed = sum(not e.truth.succeeded for e in events if isinstance(e, Acted) and e.truth)
        assert ended.questions == 0
        if at == "effect":  # what a failure may have undone besides, nothing tells
            assert ended.actions <= 6 + failed + 2
        else:  # what failed five times in a row looks dead, and may be made sure of once it works
            assert 0 <= ended.actions - 6 - failed <= late_successes(events)
        assert ended.looks <= (ended.actions if at == "look" else 1)


@pytest.mark.parametrize("failure", [0.0, 0.25])
def test_a_skill_that_is_said_to_notice_its_failures_is_heard(
    planner: Planner, tmp_path: Path, failure: float
) -> None:
    (tmp_path / "world.yaml").write_text("undo: []\nreports: [{notices: 1}]")
    monitor = "belief:notices=0.99:false_alarms=0.001"
    decisions = []
    for seed in range(8):
        ended, events = run(
            planner, monitor, rules=tmp_path / "world.yaml", seed=seed, failure=failure
        )
        assert ended.completed
        failed = 0
        for acted, decided in disinfected(events):
            repeats = decided.decision is Decision.REPEAT
            if acted.report == "failed":
                assert repeats
            elif failed < 3:  # after some failures in a row one *done* may be worth another try
                assert not repeats
            failed = failed + 1 if acted.report == "failed" else 0
            assert "as the skill reports" in decided.reason
            decisions.append(decided.decision)
        assert failure or ended.actions == 6
    assert (Decision.REPEAT in decisions) == bool(failure)


@pytest.mark.parametrize("monitor", ["tpvqa", "vote:3", "effectvqa"])
def test_the_papers_monitors_decide_as_if_nothing_were_sensed(
    planner: Planner, tmp_path: Path, monitor: str
) -> None:
    (tmp_path / "world.yaml").write_text(NOTHING)
    told = [
        [
            (event.step, event.decision, event.reason)
            for event in run(planner, monitor, rules=rules, seed=seed, limits={"actions": 20})[1]
            if isinstance(event, Decided)
        ]
        for seed in range(3)
        for rules in (WARD / "world.yaml", tmp_path / "world.yaml")
    ]
    assert told[::2] == told[1::2]


def test_a_resumed_trial_senses_what_the_unbroken_one_does(
    planner: Planner, tmp_path: Path
) -> None:
    rules = tmp_path / "world.yaml"
    rules.write_text(
        "sensed:\n  - {fact: '(contaminated ?d)', right: 0.9, at: [look, action]}\n"
        "reports: [{notices: 0.5, false_alarms: 0.1}]"
    )
    config = configured(**FILES, world_file=str(rules), world="symbolic", vlm="oracle:0.9", seed=5)
    whole = unbroken(tmp_path / "whole", config, planner)
    assert {p for e in whole if isinstance(e, Acted) for p in [f.probability for f in e.facts]} == {
        0.9,
        0.1,
    }
    for cut in range(3, len(whole), len(whole) // 3):
        assert story(resumed(tmp_path / "whole", cut, planner)) == story(whole), cut


def test_a_log_that_senses_what_its_task_does_not_know_is_not_gone_on_with(
    planner: Planner, tmp_path: Path
) -> None:
    writer = EpisodeWriter(tmp_path, durable=False)
    config = configured(**FILES, world="symbolic", vlm="oracle:1")
    with Trial(config, planner=planner) as trial:
        trial.run(writer, folder=tmp_path)
    writer.close()
    lines = [json.loads(line) for line in (tmp_path / LOG).read_text().splitlines()]
    place = next(n for n, line in enumerate(lines) if line["kind"] == "acted")
    lines[place]["facts"] = [{"atom": "(contaminated attic)", "probability": 0.5}]
    (tmp_path / LOG).write_text("".join(f"{json.dumps(line)}\n" for line in lines[:-2]))
    with pytest.raises(EpisodeError, match=rf"event {place} .* no object 'attic'"):
        resume(tmp_path)


def test_logs_from_before_anything_was_sensed_are_read(tpvqa: Run) -> None:
    assert tpvqa("run", *TRIAL, "--vlm", "oracle:1", "--out", "here")[0] == 0
    log = Path("here") / LOG
    lines = [json.loads(line) for line in log.read_text().splitlines()]
    sensed = [line.pop("facts", ()) for line in lines]
    assert any(sensed)
    log.write_text("".join(f"{json.dumps(line)}\n" for line in lines))
    code, out, _ = tpvqa("show", "here")
    assert code == 0
    assert "senses" not in out


def test_what_was_sensed_is_shown_and_reported(tpvqa: Run) -> None:
    assert tpvqa("run", *TRIAL, "--vlm", "oracle:1", "--seed", 3, "--out", "here")[0] == 0
    code, out, _ = tpvqa("show", "here", "--verbose")
    assert code == 0
    assert "the robot senses: upper drawer contaminated 1.00" in out
    assert "the robot senses: not upper drawer contaminated 1.00" in out
    assert re.search(r"repeat: not upper drawer contaminated 0\.\d\d → 0\.\d\d as sensed", out)
    assert tpvqa("report", "here", "--out", "page.html")[0] == 0
    page = Path("page.html").read_text()
    assert "the robot senses: not lower drawer contaminated 1.00" in page
    assert "as sensed" in page


def test_sensors_and_skills_are_calibrated_from_trials_and_from_episodes(tpvqa: Run) -> None:
    Path("other.yaml").write_text(
        "sensed:\n  - {fact: '(contaminated ?d)', right: 0.8, claims: 0.97}\n"
        "reports: [{action: disinfect, notices: 0.7, false_alarms: 0.05}]"
    )
    where = ["--world-file", "other.yaml", "--vlm", "oracle:0.9"]
    code, out, err = tpvqa("calibrate", *WORDS, *where, "--trials", 18, "--out", "c.json")
    assert code == 0, err
    assert re.search(r"sensed: contaminated is said to hold in 0\.\d+ where it does", out)
    assert re.search(r"skills: disinfect reports 0\.\d+ of its failures", out)
    known = Calibration.load(Path("c.json"))
    (sensor,) = known.sensors
    assert (sensor.says_if_true, sensor.says_if_false) == pytest.approx((0.8, 0.2), abs=0.12)
    (skill,) = (each for each in known.skills if each.action == "disinfect")
    assert (skill.notices, skill.false_alarms) == pytest.approx((0.7, 0.05), abs=0.17)
    given = ["--calibration", "c.json", *where]
    for seed in (1, 2):
        code, _, err = tpvqa("run", *TRIAL, *given, "--seed", seed, "--out", f"e{seed}")
        assert code in (0, 1), err
    code, out, err = tpvqa("calibrate", "e1", "e2", "--json")
    assert code == 0, err
    rows = sum(
        len(event.facts)
        for name in ("e1", "e2")
        for event in read_episode(name)
        if isinstance(event, Acted)
    )
    (sensor_told,) = json.loads(out)["sensors"]
    assert (sensor_told["predicate"], sensor_told["rows"]) == ("contaminated", rows)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ("notices=2", "both between 0 and 1"),
        ("notices=0.2:false_alarms=0.3", "no larger one of its successes"),
        ("false_alarms=0.1", "no larger one of its successes"),
        ("notices=often", "could not convert"),
        ("notice=0.9", "Did you mean 'notices'"),
    ],
)
def test_what_is_said_of_skills_has_to_make_sense(tpvqa: Run, arguments: str, says: str) -> None:
    code, _, err = tpvqa("run", *TRIAL, "--monitor", f"belief:{arguments}")
    assert code == 2
    assert says in " ".join(err.split())


def test_a_further_look_that_senses_the_same_is_no_news(tpvqa: Run, tmp_path: Path) -> None:
    rules = tmp_path / "looks.yaml"
    rules.write_text(
        f'{NOTHING}\nsensed:\n  - {{fact: "(contaminated ?d)", at: [action, look], right: 0.9}}\n'
    )
    told = tpvqa("run", *TRIAL, "--world-file", rules, "--vlm", "oracle:0.7", "--seed", 4)[1]
    assert "the robot senses" in told
    said = [line for line in told.splitlines() if "Is " not in line]
    assert not [a for a, b in pairwise(said) if a == b and "the robot senses" in a]


def test_a_look_tells_what_the_action_did_not(tpvqa: Run, tmp_path: Path) -> None:
    rules = tmp_path / "both.yaml"
    rules.write_text(
        f'{NOTHING}\nsensed:\n  - {{fact: "(contaminated ?d)", at: [action, look], right: 0.9}}\n'
        '  - {fact: "(open ?d)", at: action, right: 0.9}\n'
    )
    told = tpvqa("run", *TRIAL, "--world-file", rules, "--vlm", "oracle:0.7", "--seed", 4)[1]
    said = [line for line in told.splitlines() if "Is " not in line and "look " not in line]
    found = [
        (set(a.partition(": ")[2].split(", ")), set(b.partition(": ")[2].split(", ")))
        for a, b in pairwise(said)
        if "the robot senses" in a and "the robot senses" in b
    ]
    assert "the robot senses" in told
    assert not any(after & before for before, after in found)
