"""`tpvqa risk` and `tpvqa run --risk`, as a user types them."""

import json
from pathlib import Path

import pytest

from tests.cli.conftest import Run
from tpvqa.belief.calibrating.risk import RiskCalibration
from tpvqa.episodes import read_episode
from tpvqa.episodes.log import LOG
from tpvqa.events import Ended
from tpvqa.events.events import Decided

DRAWER = Path(__file__).parents[1] / "fixtures" / "drawer"
TASK = (DRAWER / "domain.pddl", DRAWER / "problem.pddl")
WORDS = ("--vlm", "oracle:0.8", "--monitor", "belief:failure=6:question=0.4")
TRIALS = 19
STATED = ("--risk", ".05", "--risk-file", "risk.json")


@pytest.fixture(scope="module")
def learnt(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """What was written, kept from test to test."""
    return {}


@pytest.fixture
def known(tpvqa: Run, learnt: dict[str, str]) -> RiskCalibration:
    if not learnt:
        words = (*WORDS, "--trials", TRIALS, "--workers", 1, "--json")
        code, out, err = tpvqa("risk", *TASK, *words)
        assert code == 0, err
        learnt |= {"file": Path("risk.json").read_text(), "out": out}
    Path("risk.json").write_text(learnt["file"])
    return RiskCalibration.load(Path("risk.json"))


def change(known: RiskCalibration, **changes: object) -> None:
    known.model_copy(update=changes).save(Path("risk.json"))


def last(folder: str) -> tuple[Decided, Ended]:
    events = read_episode(Path(folder))
    decided = [event for event in events if isinstance(event, Decided)]
    assert isinstance(events[-1], Ended)
    return decided[-1], events[-1]


def test_trials_tell_what_every_risk_comes_to(
    known: RiskCalibration, learnt: dict[str, str]
) -> None:
    told = json.loads(learnt["out"])
    assert (told["file"], told["trials"]) == ("risk.json", TRIALS)
    assert told["done"] == len(known.right) > 0
    assert told["wrong_done"] == len(known.wrong) > 0
    assert [row["risk"] for row in told["risks"]] == [0.05, 0.1, 0.2]
    assert told["risks"][0] == {
        "risk": 0.05,
        "above": max(known.wrong),
        "done": sum(goal > max(known.wrong) for goal in known.right) / TRIALS,
        "wrong_done": 0.0,
    }
    assert known.made_with["VLM"] == "oracle:0.8"


def test_a_doubtful_goal_is_not_called_done(tpvqa: Run, known: RiskCalibration) -> None:
    change(known, wrong=(0.97,))
    code, out, _ = tpvqa("run", *TASK, *WORDS, *STATED, "--seed", 1, "--out", "e")
    decided, ended = last("e")
    assert code == 1
    assert (ended.because, ended.believed_goal) == ("gave up", False)
    assert decided.reason.startswith("stop in doubt: drawer clean 0.")
    assert "; the goal holds with 0." in decided.reason
    assert ", and done is reported above 0.97" in decided.reason
    assert "(risk at most 0.05, by 19 trials)" in decided.reason
    assert decided.reason.endswith("; no question tells whether drawer clean")
    assert "give up: stop in doubt: drawer clean 0." in out


def test_a_goal_that_is_sure_enough_is_called_done(tpvqa: Run, known: RiskCalibration) -> None:
    change(known, wrong=(0.5,))
    tpvqa("run", *TASK, *WORDS, *STATED, "--out", "e")
    decided, ended = last("e")
    assert ended.believed_goal
    assert "above 0.50 (risk at most 0.05, by 19 trials)" in decided.reason


def test_a_resumed_trial_keeps_its_risk(tpvqa: Run, known: RiskCalibration) -> None:
    change(known, wrong=(0.97,))
    tpvqa("run", *TASK, *WORDS, *STATED, "--out", "e")
    before = last("e")
    Path("risk.json").unlink()
    lines = Path("e", LOG).read_text().splitlines(keepends=True)
    Path("e", LOG).write_text("".join(lines[: len(lines) // 2]))
    code, _, err = tpvqa("resume", "e")
    assert code == 1, err
    assert last("e")[0].reason == before[0].reason


def test_other_conditions_are_told(tpvqa: Run, known: RiskCalibration) -> None:
    _, _, err = tpvqa("run", *TASK, *WORDS, *STATED, "--failure", ".4", "--out", "e")
    assert "not promised under these: --failure the default there, 0.4 here" in " ".join(
        err.split()
    )
    _, _, err = tpvqa("run", *TASK, *WORDS, *STATED, "--seed", known.seed, "--out", "f")
    assert "this very trial is one of those" in err
    _, _, err = tpvqa("run", *TASK, *WORDS, *STATED, "--out", "g")
    assert "the risk was" not in err
    assert "this very" not in err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ((*WORDS, "--risk", ".05"), ["tpvqa risk TASK", "--risk-file"]),
        (("--vlm", "oracle:0.8", *STATED), ["monitor belief:failure=6", "same options"]),
        ((*WORDS[2:], "--vlm", "oracle:0.9", *STATED), ["VLM oracle:0.8 there, oracle:0.9 here"]),
        ((*WORDS, "--risk", ".02", "--risk-file", "risk.json"), ["at least 49 trials", "19"]),
        ((*WORDS, "--risk-file", "risk.json"), ["state it with --risk"]),
        ((*WORDS, "--risk", ".05", "--risk-file", "none.json"), ["none.json", "tpvqa risk --out"]),
        ((*WORDS, "--risk", "1.5"), ["--risk", "less than 1"]),
        (("--monitor", "tpvqa", "--risk", ".05"), ["tpvqa states no risk", "--monitor belief"]),
    ],
)
def test_what_does_not_fit_says_what_to_do(
    tpvqa: Run, known: RiskCalibration, words: tuple[str, ...], said: list[str]
) -> None:
    assert known.trials == TRIALS
    code, _, err = tpvqa("run", *TASK, *words, "--out", "e")
    assert code == 2
    for word in said:
        assert word in " ".join(err.split())
    assert not Path("e").exists()


def test_only_a_belief_without_a_risk_tells_one(tpvqa: Run) -> None:
    for monitor in ("tpvqa", "belief:risk=.05"):
        code, _, err = tpvqa("risk", *TASK, "--monitor", monitor)
        assert code == 2
        assert "--monitor belief" in err
    assert not list(Path().glob("risk*"))


@pytest.mark.parametrize("force", [False, True])
def test_only_a_risk_file_is_written_over(
    tpvqa: Run, known: RiskCalibration, *, force: bool
) -> None:
    words = ("risk", *TASK, *WORDS, "--trials", 1, "--workers", 1)
    Path("mine.json").write_text("work")
    code, _, err = tpvqa(*words, "--out", "mine.json", *(["--force"] if force else []))
    assert (code, "mine.json is there" in err) == ((0, False) if force else (2, True))
    assert (Path("mine.json").read_text() == "work") is not force
    code, _, err = tpvqa(*words, "--out", "risk.json")
    assert (code, RiskCalibration.load(Path("risk.json")).trials) == (0, 1), err


def test_a_risk_file_does_not_take_the_place_of_the_task(tpvqa: Run) -> None:
    for file in TASK:
        Path(file.name).write_bytes(file.read_bytes())
    code, _, err = tpvqa(
        *("risk", "domain.pddl", "problem.pddl", *WORDS, "--trials", 1),
        *("--out", "problem.pddl", "--force"),
    )
    assert (code, "problem.pddl is read by this command" in err) == (2, True)
    assert Path("problem.pddl").read_bytes() == TASK[1].read_bytes()
