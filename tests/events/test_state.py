"""The fold: where a trial stands follows from its events alone."""

from collections.abc import Iterator

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.doubles import configured
from tpvqa.assembly import Trial
from tpvqa.episodes import MemoryWriter
from tpvqa.events import EVENT, Decision, Ended, Event, TrialState
from tpvqa.events.events import Acting, Answered, Decided, PlanMade
from tpvqa.planning import Planner
from tpvqa.planning.fast_downward import FastDownward
from tpvqa.planning.remembering import Remembering

MONITORS = ["tpvqa", "tpvqa:3", "belief", "tp", "palmevqa", "successvqa"]


@pytest.fixture(scope="module")
def planner() -> Iterator[Planner]:
    planner = Remembering(FastDownward())
    yield planner
    planner.close()


def trial(planner: Planner, monitor: str, seed: int) -> tuple[list[Event], TrialState]:
    config = configured(
        task="build_tower", world="symbolic", vlm="oracle:0.8", monitor=monitor, seed=seed
    )
    writer = MemoryWriter()
    with Trial(config, planner=planner) as made:
        steps, performer = made.stepping(writer), made.performer(writer)
        steps.begin()
        while steps.pending is not None:
            steps.send(performer.perform(steps.pending))
        assert steps.conclusion is not None
        steps.end(steps.conclusion, goal_holds=None)
    return writer.events, steps.state


def folded(events: list[Event]) -> TrialState:
    state = TrialState()
    for event in events:
        state = state.after(event)
    return state


@pytest.mark.parametrize("monitor", MONITORS)
def test_a_log_that_is_read_back_leads_to_where_the_trial_stood(
    planner: Planner, monitor: str
) -> None:
    for seed in range(3):
        events, state = trial(planner, monitor, seed)
        lines = [EVENT.dump_json(event, by_alias=True, exclude_none=True) for event in events]
        assert folded([EVENT.validate_json(line) for line in lines]) == state


@settings(max_examples=25, deadline=None)
@given(monitor=st.sampled_from(MONITORS), seed=st.integers(0, 10**6))
def test_what_is_counted_is_what_happened(planner: Planner, monitor: str, seed: int) -> None:
    events, state = trial(planner, monitor, seed)
    ended = events[-1]
    assert isinstance(ended, Ended)
    assert state.actions == sum(isinstance(event, Acting) for event in events) == ended.actions
    assert state.questions >= sum(len(e.answers) for e in events if isinstance(e, Answered))
    assert state.looks == sum(event.kind == "observed" for event in events)
    now = TrialState()
    for event in events:
        before, now = now, now.after(event)
        match event:
            case Acting():
                assert before.action == event.action
                assert (before.index, before.attempt) == (event.step, event.attempt)
            case Decided():
                assert (before.index, before.when) == (event.step, event.when)
                assert before.decided is not event
            case Answered():
                assert [told.answer for told in now.latest] == list(event.answers)
                assert now.asked is not None
                assert [told.question for told in now.latest] == list(now.asked.questions)
            case PlanMade(considered=False, result="plan"):
                assert (now.index, now.attempt) == (0, 0)
        assert now.actions_left is None or now.actions_left >= 0
        assert (
            0
            <= now.repeats
            <= sum(isinstance(e, Decided) and e.decision is Decision.REPEAT for e in events)
        )


def test_what_is_asked_in_one_check_is_together(planner: Planner) -> None:
    events, _ = trial(planner, "tpvqa:3", 1)
    now, last, told = TrialState(), -1, 0
    for event in events:
        before, now = now, now.after(event)
        if isinstance(event, Decided) and before.exchanges:
            looks = [each.look for each in before.exchanges]
            assert looks == sorted(looks)
            assert looks[0] > last
            last, told = looks[-1], told + len(looks)
    assert told == sum(len(event.answers) for event in events if isinstance(event, Answered))
