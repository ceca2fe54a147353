"""The rivals: blind repetition, votes everywhere, each fact until it is decided."""

from collections.abc import Callable, Iterator
from itertools import chain, cycle, repeat

import pytest

from tests.doubles import configured, perform
from tests.monitors.conftest import agree
from tpvqa.assembly import Trial
from tpvqa.bench.cell import Cell
from tpvqa.config import TrialConfig
from tpvqa.episodes import MemoryWriter
from tpvqa.errors import PluginError
from tpvqa.events.decision import Decision
from tpvqa.events.events import Acting, Asked
from tpvqa.monitors import Step
from tpvqa.monitors.lead import SILENT, Lead
from tpvqa.monitors.votes import Votes
from tpvqa.plugins import Kind, make
from tpvqa.questions import Question
from tpvqa.vlm import Reply

At = Callable[..., Step]


def test_blind_does_every_action_so_many_times_and_never_asks() -> None:
    writer = MemoryWriter()
    with Trial(configured(task="clean_dishes", monitor="blind:3", world="symbolic")) as trial:
        ended = trial.run(writer)
    did = [event.action.pddl() for event in writer.events if isinstance(event, Acting)]
    assert len(did) == 3 * len(set(did)) == ended.actions
    assert did == [action for action in dict.fromkeys(did) for _ in range(3)]
    assert not any(isinstance(event, Asked) for event in writer.events)


def test_a_lead_is_asked_for_until_it_is_there(at: At) -> None:
    told: dict[str, Iterator[Reply]] = {}

    def replies(question: Question) -> Reply:
        right = agree(question)
        wrong = Reply.NO if right is Reply.YES else Reply.YES
        answers = told.setdefault(question.text, chain([wrong], repeat(right)))
        return next(answers)

    verdict, looks, asked = perform(Lead(3).after(at(1)), replies)
    assert verdict.decision is Decision.GO_ON
    assert looks == 5  # one against, four for
    assert len(asked) == 10


def test_of_a_lead_a_question_that_is_decided_is_asked_no_more(at: At) -> None:
    def replies(question: Question) -> Reply:
        return Reply.UNKNOWN if "table" in question.text else agree(question)

    verdict, looks, asked = perform(Lead(2).after(at(1)), replies)
    assert verdict.decision is Decision.GO_ON
    assert [text for text in asked if "table" not in text] == [
        "Is the plate in a robot's hand?"
    ] * 2
    assert looks == 2 + SILENT + 1


def test_a_single_denied_fact_denies_under_a_lead(at: At) -> None:
    def replies(question: Question) -> Reply:
        return Reply.NO if "hand" in question.text else agree(question)

    assert perform(Lead(2).after(at(1)), replies)[0].decision is Decision.REPEAT
    monitor = Lead(2)
    verdict, _, _ = perform(monitor.before(at(3, monitor)), replies)
    assert verdict.decision is Decision.REPLAN


def test_a_coin_that_never_gets_ahead_ends(at: At) -> None:
    coin = cycle([Reply.YES, Reply.NO])
    verdict, looks, _ = perform(Lead(2).after(at(0)), lambda question: next(coin))
    assert (verdict.decision, looks) == (Decision.GIVE_UP, 400)


@pytest.mark.parametrize("monitor", [lambda: Votes(3), lambda: Lead(2)])
def test_the_goal_is_checked_at_the_end_and_what_is_denied_taken_out(
    monitor: Callable[[], Votes | Lead], at: At
) -> None:
    asked_before: list[str] = []

    def unclean_in_the_end(question: Question) -> Reply:
        asked_before.append(question.text)
        later = asked_before.count("Is the plate clean?") > 3
        return Reply.NO if later and "clean" in question.text else agree(question)

    made = monitor()
    verdict, _, _ = perform(made.after(at(3, made)), unclean_in_the_end)
    if isinstance(made, Votes):
        assert verdict.decision is Decision.REPLAN
        assert verdict.state is not None
        assert "clean" not in {atom.predicate for atom in verdict.state}
    sure = monitor()
    verdict, _, asked = perform(sure.after(at(3, sure)), agree)
    assert verdict.decision is Decision.GO_ON
    assert asked.count("Is the plate clean?") == 2 * (3 if isinstance(sure, Votes) else 2)


@pytest.mark.parametrize("spec", ["tpvqa:101", "tpvqa:1000000:strict"])
def test_votes_end(spec: str) -> None:
    with pytest.raises(PluginError, match=r"A vote over \d+ looks is too long; take 100 at"):
        make(Kind.MONITOR, spec)
    assert make(Kind.MONITOR, "tpvqa:100").name == "tpvqa:100"
    assert make(Kind.MONITOR, "vote:100").name == "vote:100"


@pytest.mark.parametrize(
    "spec",
    ["blind", "blind:0", "blind:x", "vote", "vote:0", "vote:3:most", "lead:0", "lead", "lead:-1",
     "vote:101", "vote:1000000:strict", "lead:101", f"vote:{'9' * 5000}", f"lead:{'9' * 5000}"],
)  # fmt: skip
def test_arguments_that_mean_nothing_are_refused(spec: str) -> None:
    with pytest.raises(PluginError, match=f"'{spec.partition(':')[0]}:.*' is not understood"):
        make(Kind.MONITOR, spec)


@pytest.mark.parametrize(
    "spec",
    ["blind:5", "vote:5", "vote:5:strict", "lead:4", "effectvqa:strict", "tpvqa:3:no-alternatives"],
)
def test_a_rival_calls_itself_as_it_is_called(spec: str) -> None:
    assert make(Kind.MONITOR, spec).name == spec


def test_limits_that_do_not_bind_are_a_condition_of_a_bench() -> None:
    cell = Cell("clean_dishes", "blind:5", "oracle:0.8", "symbolic", "limits=none,redo=risky")
    config = cell.config(TrialConfig(), 0)
    assert (config.limits.repeats, config.limits.replans) == (None, None)
    assert config.limits.actions_of(4) == 200
    assert config.simulation is not None
    assert config.simulation.redo == "risky"
    assert TrialConfig.model_validate(config.model_dump()) == config
