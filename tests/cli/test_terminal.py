"""What the terminal says of answers, decisions and the end: in few words, in 80 columns."""

import re
from collections.abc import Iterable, Sequence
from io import StringIO
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console

from tests.cli.conftest import Run
from tests.cli.test_belief_view import shown
from tests.episodes.believing import (
    DOUBTED,
    FIND,
    FLIPPED,
    PICK,
    UNSURE,
    decided,
    plan,
    started,
)
from tpvqa.cli.brief import MORE, brief
from tpvqa.cli.terminal import EpisodeView
from tpvqa.config import TrialConfig
from tpvqa.episodes import read_episode
from tpvqa.episodes.agreement import Agreement
from tpvqa.episodes.fact_words import words_of
from tpvqa.episodes.report import tell
from tpvqa.episodes.true_start import MOST, true_start_said
from tpvqa.events import Event, TrialState
from tpvqa.events.events import (
    Acted,
    Acting,
    Answered,
    AnswerRecord,
    Asked,
    Believed,
    Decided,
    Ended,
    FrameRecord,
    Observed,
    OutcomeRecord,
    PlanMade,
    QuestionRecord,
    Started,
)
from tpvqa.monitors import Decision
from tpvqa.questions import Way
from tpvqa.vlm import Reply
from tpvqa.worlds import Report
from tpvqa.worlds.outcome import Failure

REASON = (
    "bread in a robot's hand (left) 0.00 after a no, which place the bread on the plate (step 4) "
    "needs; plate in the image 0.74 → 0.04 after two noes, which place the bread on the plate "
    "(step 4) needs; replanning from bread on the floor (1.00) and bread in the image (0.96)"
)


def asked(atom: str, reply: Reply, *, expected: bool = True) -> list[Event]:
    """A question about a fact, as a monitor that weighs answers asks it, and its answer."""
    question = QuestionRecord(text=f"{atom}?", way=Way.EFFECT, atom=atom, expected=expected)
    return [
        Observed(
            look=0,
            world_time=0,
            frames=(FrameRecord(view="front", file="f.jpg", media_type="image/jpeg"),),
        ),
        Asked(look=0, questions=(question,)),
        Answered(answers=(AnswerRecord(reply=reply, text=reply),)),
    ]


def picked(*exchanges: Sequence[Event]) -> list[Event]:
    """The bread, near and on the table, is picked up; then something is asked."""
    begun = started().model_copy(
        update={"initial": ("(near bread)", "(on bread table)", "(free left)")}
    )
    return [
        begun,
        plan(PICK),
        Acting(step=0, action=PICK, attempt=0),
        Acted(report=Report.DONE, seconds=0.0),
        *(event for each in exchanges for event in each),
    ]


@pytest.mark.parametrize(
    ("atom", "reply", "mark"),
    [
        ("(in_hand bread left)", Reply.YES, "✓"),
        ("(in_hand bread left)", Reply.NO, "✗"),
        ("(on bread table)", Reply.NO, "✓"),  # no longer there, as is expected
        ("(on bread table)", Reply.YES, "✗"),
        ("(on bread floor)", Reply.NO, "✓"),
        ("(on bread floor)", Reply.CANNOT_SEE, "?"),
        ("(in_hand bread left)", Reply.UNKNOWN, "?"),
    ],
)
def test_a_mark_says_whether_an_answer_is_as_expected(atom: str, reply: Reply, mark: str) -> None:
    events = picked(asked(atom, reply))
    (line,) = [line for line in shown(events) if f"{atom}?" in line]
    assert line.strip().startswith(f"{mark} {atom}? {reply}")
    (told,) = tell(events, words_of(events[0])).actions[0].after.checks[0].exchanges  # type: ignore[arg-type]
    assert told.agrees is {"✓": True, "✗": False, "?": None}[mark]


def test_before_an_action_what_is_believed_is_expected() -> None:
    events = [*picked()[:2], *asked("(on bread table)", Reply.YES)]
    assert any("✓ (on bread table)? yes" in line for line in shown(events))


def test_what_a_monitor_wants_denied_says_so_itself() -> None:
    """Whatever is believed: the paper's monitors ask about literals."""
    events = picked(asked("(in_hand bread left)", Reply.NO, expected=False))
    assert any("✓ (in_hand bread left)? no" in line for line in shown(events))


def test_without_a_domain_that_can_be_read_the_questions_own_expectation_counts() -> None:
    begun = started(domain="(define (domain of-another-version")
    state = TrialState()
    for event in (begun, plan(PICK), *asked("(on bread floor)", Reply.YES)):
        state = state.after(event)
    assert Agreement(words_of(begun)).of(state.latest[0], state) is True


def test_many_answers_of_one_question_are_marked_by_most_of_them() -> None:
    text = picked(*(asked("(on bread table)", r) for r in (Reply.NO, Reply.YES, Reply.NO)))
    bare: list[Event] = [each for each in text if not isinstance(each, Observed)]
    assert any(
        "✓ (on bread table)? 1 yes, 2 no  nyn" in line for line in shown([*bare, decision("")[-1]])
    )


def decision(reason: str) -> list[Event]:
    """A replan, for a reason."""
    known = decided("after", 0, Decision.REPLAN).model_copy(update={"reason": reason})
    return [*picked(), known]


def test_a_decision_is_one_line_with_its_numbers_first() -> None:
    (line,) = [line for line in shown(decision(REASON)) if "replan" in line]
    assert line == (
        "  → replan: bread in a robot's hand (left) 0.00; plate in the image 0.74 → 0.04; …"
    )


@given(st.lists(st.text("abc 0.9→()?", min_size=1, max_size=80), min_size=1, max_size=8))
def test_no_decision_is_longer_than_a_line(parts: list[str]) -> None:
    reason = "; ".join(parts)
    said = brief(reason, 88)
    assert len(said) <= 88
    assert said == reason or len(reason) > 88 or MORE not in said


@pytest.mark.parametrize(
    ("reason", "said"),
    [
        (
            "bow line coiled 0.00 (not worth asking); stern line coiled 0.00 (not worth asking); "
            "no change of plan is left, and the goal holds with only 0.00",
            "bow line coiled 0.00; …; no change of plan is left, and the goal holds with only 0.00",
        ),
        (
            "put the halter on Bess failed in about 32 of 32 tries; Bess sound 0.00; girth tight "
            "0.00 (not worth asking); no other way is known, and the goal holds with only 0.00",
            "put the halter on Bess failed in about 32 of 32 tries; …; no other way is known, and "
            "the goal holds with only 0.00",
        ),
        (
            "the goal holds with 0.97; asked what is known to see what answers are worth; and more "
            "that does not fit into any line",
            "the goal holds with 0.97; asked what is known to see what answers are worth; …",
        ),
        (
            "cup in hand 0.02; no plan is left, and the goal holds with 0.01; asked what is known "
            "to see what answers are worth (cup clean, tea hot)",
            "cup in hand 0.02; no plan is left, and the goal holds with 0.01; …",
        ),
    ],
)
def test_what_a_trial_is_ended_for_is_never_left_out(reason: str, said: str) -> None:
    assert brief(reason, 86) == said


def test_what_was_sensed_is_not_cut_amid_a_phrase() -> None:
    reason = (
        "windlass in hand 0.93 → 0.02 as sensed and after two noes, which lay down the windlass at "
        "the top gate (step 2) needs; on to push open the top gate (step 3), which can be done"
    )
    said = "windlass in hand 0.93 → 0.02 as sensed; on to push open the top gate (step 3)"
    assert brief(reason, 84) == said


@pytest.mark.parametrize(
    ("reason", "said"),
    [
        (
            "safelight lit 0.50 → 0.05 after two noes, which load the film into the reel (step 4) "
            "needs; on to mix the developer (step 6), which can be done already: jug clean (0.98)",
            "safelight lit 0.50 → 0.05 after two noes; on to mix the developer (step 6)",
        ),
        (
            "tank dry 0.50 → 0.05 after two noes, which load the film into the reel (step 4) "
            "needs; on to mix the developer (step 6), as what comes before it is done already: "
            "safelight lit (0.98)",
            "tank dry 0.50 → 0.05 after two noes; on to mix the developer (step 6)",
        ),
        (
            "jobo capped 0.00; robot holding the developer in its left gripper 0.00 after a no; "
            "back to cap the jobo (step 5): developer lying in the wet room (1.00)",
            "jobo capped 0.00; …; back to cap the jobo (step 5)",
        ),
        (
            "the picture of the projector on the wall of the dry room sharp and bright 0.02; "
            "find the TV again; asked what is known to see what answers are worth (roll dry 1.00)",
            "…; find the TV again; …",
        ),
    ],
)
def test_what_is_done_next_is_never_left_out(reason: str, said: str) -> None:
    assert brief(reason, 76) == said


def test_the_whole_reason_is_there_on_request_and_wraps(tpvqa: Run) -> None:
    lines = _in_terminal(decision(REASON), verbose=True)
    assert max(map(len, lines)) <= 80
    first = next(n for n, line in enumerate(lines) if "→ replan:" in line)
    rest = lines[first : first + 4]
    assert all(line.startswith("    ") for line in rest[1:])
    assert re.sub(r"\s+", " ", " ".join(rest)).strip() == f"→ replan: {REASON}"
    code, short, _ = tpvqa("run", "build_tower", "--seed", 7, "--vlm", "oracle:0.8", "--out", "e")
    assert code in (0, 1)
    _, full, _ = tpvqa("show", "e", "--verbose")
    assert ", which the goal needs" in full
    assert max(len(line) for line in short.splitlines() if "→" in line[:4]) <= 100


def _in_terminal(events: Iterable[Event], *, verbose: bool = False) -> list[str]:
    console = Console(file=StringIO(), force_terminal=True, color_system=None, width=80)
    view = EpisodeView(console, live=False, verbose=verbose)
    for event in events:
        view(event)
    assert isinstance(console.file, StringIO)
    return console.file.getvalue().splitlines()


def ended(**how: object) -> Ended:
    """The end of a trial that took one of everything."""
    counts = dict.fromkeys(("actions", "questions", "looks", "repeats"), 1)
    given = {"because": "goal", "believed_goal": False, "completed": False, "replans": 2}
    return Ended.model_validate({**counts, **given, **how})


COUNTS = "(1 action, 1 question, 1 repeat, 2 replans)"


@pytest.mark.parametrize(
    ("end", "says"),
    [
        (ended(believed_goal=True, completed=True), "goal reached"),
        (ended(believed_goal=True, completed=None), "goal reached, as is believed"),
        (ended(believed_goal=True), "goal not reached, though it was believed to be"),
        (
            ended(believed_goal=True, unmet=("(on bread plate)", "(not (in_hand bread left))")),
            "goal not reached, though it was believed to be. Not so: bread on the plate; "
            "not bread in a robot's hand (left)",
        ),
        (
            ended(because="gave up", goal_holds=True),
            "goal reached, though it was not believed to be: gave up, at step 2 of 2, "
            "pick up the bread",
        ),
        (
            ended(because="limit of repeats"),
            "goal not reached: limit of repeats, at step 2 of 2, pick up the bread",
        ),
        (
            ended(because="gave up", message="because after 1", completed=None),
            "goal not reached: gave up, at step 2 of 2, pick up the bread",
        ),
        (
            ended(because="world refused", message="the gripper is cold"),
            "goal not reached: world refused: the gripper is cold, at step 2 of 2, "
            "pick up the bread",
        ),
    ],
)
def test_the_last_line_says_where_a_trial_ended_and_why(end: Ended, says: str) -> None:
    reason: Decided = decided("after", 1, Decision.GIVE_UP)
    lines = shown([started(), plan(FIND, PICK), reason, end])
    assert lines[-1] == f"{says} {COUNTS}"


def test_what_is_only_the_likeliest_way_on_is_not_said_to_be_believed() -> None:
    moved = Believed(added=(FLIPPED, UNSURE), removed=(DOUBTED,))
    reason = decided("after", 1, Decision.GO_ON, near=0.9, held=0.2)
    *_, line = shown([started(), plan(FIND, PICK), reason, moved])
    assert line == (
        "  now believed: bread in the image; no longer: bread in a robot's hand (left); "
        "acts as if: bread on the plate"
    )
    *_, line = shown([started(), plan(FIND, PICK), moved])
    assert "acts as if" not in line


def test_why_there_is_no_plan_is_said_once() -> None:
    why = "(lit moon): nothing brings it about"
    made = PlanMade(state=(), result="unsolvable", reason=why)
    text = "\n".join(shown([started(), made, ended(because="no plan", message=why)]))
    assert text.count(why) == text.count("no plan") == 1
    assert text.endswith(f"goal not reached: no plan: {why} {COUNTS}")


def test_a_scripted_failure_says_what_failed() -> None:
    truth = OutcomeRecord(failure=Failure.SCRIPT)
    events = [*picked()[:3], Acted(report=Report.DONE, seconds=0.0, truth=truth)]
    assert shown(events)[-1] == "  in truth: the action failed, as the script says"


def test_what_was_elsewhere_from_the_start_is_told(tpvqa: Run) -> None:
    given = ("--elsewhere", 1, "--failure", 0, "--monitor", "none", "--out", "e")
    _, ran, _ = tpvqa("run", "serve_breakfast", *given)
    _, told, _ = tpvqa("show", "e")
    tpvqa("report", "e")
    began = read_episode(Path("e"))[0]
    assert isinstance(began, Started)
    assert began.true_start is not None
    (there,) = set(began.true_start) - set(began.initial)
    (gone,) = set(began.initial) - set(began.true_start)
    say = words_of(began).say
    said = f"{say(there)}, not {say(gone)}"
    assert f"\nin truth: {said}\n" in ran
    assert f"\nin truth: {said}\n" in told
    assert f"In truth, at the start: {said}<" in Path("e/report.html").read_text()


@pytest.mark.parametrize("more", [0, 3])
def test_of_many_facts_that_are_not_as_the_problem_says_some_are_told(more: int) -> None:
    there = tuple(f"(near thing{number:02})" for number in range(MOST + more))
    simulated = TrialConfig().but(simulation={"failure": 0.0})
    began = started().model_copy(update={"initial": (), "true_start": there, "config": simulated})
    said = true_start_said(began, str).split(", ")
    assert said[:MOST] == list(there[:MOST])
    assert said[MOST:] == ([f"and {more} more"] if more else [])
    real = began.model_copy(update={"config": simulated.model_copy(update={"simulation": None})})
    assert true_start_said(real, str) == ""
    assert true_start_said(began.model_copy(update={"true_start": None}), str) == ""
