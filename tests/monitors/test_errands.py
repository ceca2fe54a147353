"""Goals out of sight in the end: gone back to and looked at where that is worth the steps."""

import itertools
from pathlib import Path

import pytest

from tests import ward
from tests.ward import DOMAIN
from tpvqa.assembly import Trial
from tpvqa.belief.weighing.vantage import Vantage
from tpvqa.config import TrialConfig
from tpvqa.drivers import performing
from tpvqa.episodes import MemoryWriter
from tpvqa.events import Event
from tpvqa.events.events import Acted, Answered, Asked, Decided, Ended, PlanMade
from tpvqa.vlm import Reply
from tpvqa.vlm.answer import CAMERA

PROBLEM = """(define (problem lamps) (:domain ward)
 (:objects hall store theatre - room lamp pump - tool anna - patient)
 (:init (at hall) (free) (in lamp theatre) (in pump hall) (lies anna theatre) (needs anna lamp))
 (:goal (and (in lamp store) (at hall))))"""
SHOWN = "shown: [{fact: '(in ?t ?r)', where: '(at ?r)'}]"


def run(
    folder: Path,
    episode: int,
    shown: str = SHOWN,
    *,
    problem: str = PROBLEM,
    vlm: str = "oracle:0.9",
    failure: float = 0.4,
    disturbance: float = 0.9,
) -> tuple[Ended, list[Event]]:
    for name, text in (
        ("domain.pddl", DOMAIN),
        ("problem.pddl", problem),
        ("world.yaml", shown),
    ):
        (folder / name).write_text(text)
    config = TrialConfig().but(
        task={
            "domain": str(folder / "domain.pddl"),
            "problem": str(folder / "problem.pddl"),
            "world_file": str(folder / "world.yaml"),
        },
        seed=3,
        episode=episode,
        vlm={"spec": vlm},
        world={"spec": "symbolic"},
        monitor={"spec": "belief"},
        simulation={"failure": failure, "disturbance": disturbance},
        limits={"repeats": "none", "replans": "none", "actions": "50x"},
    )
    writer = MemoryWriter(resumable=False)
    with Trial(config) as trial:
        ended = trial.run(writer)
    return ended, writer.events


def errands(events: list[Event]) -> list[str]:
    return [e.reason for e in events if isinstance(e, Decided) and "cannot be seen" in e.reason]


@pytest.fixture(scope="module")
def went(tmp_path_factory: pytest.TempPathFactory) -> tuple[int, Ended, list[Event]]:
    """The first trial, and its number, in which the robot went back for a look, and came there:
    going fails, and is taken to have worked where the answers say so."""
    folder = tmp_path_factory.mktemp("ward")
    for episode in range(40):
        ended, events = run(folder, episode)
        if errands(events) and {Reply.YES, Reply.NO} & {*seen(events)}:
            return episode, ended, events
    raise AssertionError("nothing was gone back to and seen in any of forty trials")


@pytest.fixture(scope="module")
def gone(went: tuple[int, Ended, list[Event]]) -> tuple[Ended, list[Event]]:
    """That trial."""
    return went[1:]


def seen(events: list[Event]) -> list[Reply]:
    """What was answered about the lamp after the robot had set out for a look."""
    first = next(n for n, e in enumerate(events) if isinstance(e, Decided) and errands([e]))
    return [
        answered.answers[0].reply
        for asked, answered in itertools.pairwise(events[first:])
        if isinstance(asked, Asked) and isinstance(answered, Answered)
        if asked.questions[0].atom == "(in lamp store)"
    ]


def test_a_goal_out_of_sight_is_gone_back_to_and_looked_at(
    gone: tuple[Ended, list[Event]],
) -> None:
    ended, events = gone
    assert ended.completed
    assert ended.because == "goal"
    first = next(n for n, e in enumerate(events) if isinstance(e, Decided) and errands([e]))
    assert any(isinstance(e, PlanMade) and e.towards == ("(at store)",) for e in events[:first])
    about = "(in lamp store)"
    looked = next(
        n
        for n, e in enumerate(events)
        if n > first and isinstance(e, Asked) and e.questions[0].atom == about
    )
    assert any(isinstance(e, Acted) for e in events[first:looked])
    assert {Reply.YES, Reply.NO} & {*seen(events)}


def test_where_everything_is_shown_there_is_nothing_to_go_back_for(
    tmp_path: Path, went: tuple[int, Ended, list[Event]]
) -> None:
    told = [run(tmp_path, episode, shown="shown: []")[1] for episode in {0, 1, went[0]}]
    assert not any(isinstance(event, PlanMade) and event.towards for each in told for event in each)


def test_a_place_is_not_gone_back_to_for_what_it_would_say_again(tmp_path: Path) -> None:
    # Two goals, each shown in a place of its own: the robot went to and fro between them.
    both = PROBLEM.replace("(in lamp store)", "(in lamp store) (in pump theatre)")
    vlm = "oracle:0.8:0:0.74"
    for episode in (8, 13, 17, 19):
        ended, events = run(tmp_path, episode, problem=both, vlm=vlm, failure=0.3, disturbance=0.5)
        assert ended.completed
        assert any(e.towards == ("(at store)",) for e in events if isinstance(e, PlanMade))
        assert 1 <= len(errands(events)) <= 3
        assert {Reply.YES, Reply.NO} & {*seen(events)}


def test_what_is_out_of_sight_is_hardly_asked_about(tmp_path: Path) -> None:
    # Of what was asked in these trials one question in three found no answer.
    replies = [
        answer.reply
        for episode in range(3)
        for event in run(tmp_path, episode, vlm="oracle:0.9:0:0.74")[1]
        if isinstance(event, Answered)
        for answer in event.answers
    ]
    assert Reply.CANNOT_SEE in replies  # going fails, and is believed to have worked
    assert replies.count(Reply.CANNOT_SEE) <= 0.1 * len(replies)


@pytest.mark.parametrize("hall", ["hall", "zhall"])  # comes before the other rooms, and after
def test_at_first_only_what_is_shown_here_is_asked_about(tmp_path: Path, hall: str) -> None:
    _, events = run(tmp_path, 0, problem=ward.PROBLEM.replace("hall", hall))
    first = next(number for number, event in enumerate(events) if isinstance(event, Acted))
    asked = {str(q.atom) for e in events[:first] if isinstance(e, Asked) for q in e.questions}
    here = {f"(in lamp {hall})", f"(in pump {hall})"}
    assert {fact for fact in asked if fact.startswith("(in ")} <= here
    assert asked & here


def test_a_dead_camera_tells_nothing_of_the_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    taken: list[Reply] = []
    monkeypatch.setattr(Vantage, "take", lambda _, atoms, reply: taken.append(reply))
    monkeypatch.setattr(performing, "seen_by", lambda vlm, seen, *faults: (seen, "it is black"))
    _, events = run(tmp_path, 0)
    answers = [answer for e in events if isinstance(e, Answered) for answer in e.answers]
    assert {(each.reply, each.source) for each in answers} == {(Reply.CANNOT_SEE, CAMERA)}
    assert not taken
