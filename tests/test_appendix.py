"""The real-robot trial of the paper's appendix, told with a scripted world and a scripted VLM."""

from tests.doubles import ScriptedVLM, configured, known_truth, truthful
from tpvqa.assembly import Trial
from tpvqa.episodes import MemoryWriter
from tpvqa.events.events import Acting, Answered, Asked, Decided, Ended, PlanMade
from tpvqa.monitors import Decision
from tpvqa.questions import Question
from tpvqa.vlm import Reply


def test_the_container_drops_the_plan_starts_again_and_a_failed_pick_is_repeated() -> None:
    config = configured(task="collect_toys", monitor="tpvqa")
    writer = MemoryWriter()
    with Trial(config) as trial:
        assert (trial.world_spec, trial.vlm_spec) == ("scripted", "oracle")

        def sees(question: Question) -> Reply:
            return truthful(question, known_truth(trial.world).holds)

        trial.parts.vlm = ScriptedVLM(sees)
        ended = trial.run(writer)

    done = [event.action.said for event in writer.events if isinstance(event, Acting)]
    assert done[:3] == [
        "find the blue container",
        "pick up the blue container",
        "find the goal area",
    ]

    # Before placing it, its precondition is denied, and the plan starts again with another one.
    asked = [event for event in writer.events if isinstance(event, Asked)]
    assert any(
        q.text == "Is the blue container in a robot's hand?" for a in asked for q in a.questions
    )
    replans = [
        event
        for event in writer.events
        if isinstance(event, Decided) and event.decision is Decision.REPLAN
    ]
    assert [event.action for event in replans] == ["(place blue_container goal_area)"]
    plans = [event for event in writer.events if isinstance(event, PlanMade)]
    assert len(plans) == 2
    assert plans[1].plan[0].said == "find the cyan container"

    # The pick fails: "on the table" yes, "in hand" no, so it is repeated.
    (repeat,) = [
        event
        for event in writer.events
        if isinstance(event, Decided) and event.decision is Decision.REPEAT
    ]
    assert repeat.action == "(pick_up toy_eggplant)"
    at = writer.events.index(repeat)
    answered, question = writer.events[at - 1], writer.events[at - 2]
    assert isinstance(answered, Answered)
    assert isinstance(question, Asked)
    said = {q.text: a.reply for q, a in zip(question.questions, answered.answers, strict=True)}
    assert said == {
        "Is the toy_eggplant in a robot's hand?": Reply.NO,
        "Is there a toy_eggplant on the table?": Reply.YES,
    }
    assert done.count("pick up the toy_eggplant") == 2

    assert isinstance(ended, Ended)
    assert ended.completed
    assert (ended.because, ended.repeats, ended.replans) == ("goal", 1, 1)
    assert done[-1] == "place the toy_eggplant into the cyan container"
