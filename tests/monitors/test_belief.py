"""The belief monitor, at the seam a user touches: whole trials."""

import re
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

import pytest

from tests.doubles import Answerer, ScriptedVLM, configured, known_truth, truthful
from tests.resumed import story
from tpvqa.assembly import Trial
from tpvqa.belief import AnswerRates, Calibration, Group
from tpvqa.belief.calibrating.calibration import Curve
from tpvqa.belief.filtering.faults import FaultModel
from tpvqa.config import TrialConfig
from tpvqa.episodes import MemoryWriter
from tpvqa.errors import PluginError
from tpvqa.events import Ended, Limits
from tpvqa.events.events import Acting, Answered, Asked, Decided, Event, PlanMade
from tpvqa.monitors.belief import BeliefMonitor
from tpvqa.observation import Frame, Observation
from tpvqa.pddl import Literal, literals, load_task
from tpvqa.planning import Planner
from tpvqa.planning.fast_downward import FastDownward
from tpvqa.planning.remembering import Remembering
from tpvqa.questions import Question
from tpvqa.tasks import find_task
from tpvqa.vlm import Answer, Reply
from tpvqa.vlm.protocol import TruthSource
from tpvqa.worlds.symbolic import SymbolicWorld
from tpvqa.worlds.world_file import load_world_file


@pytest.fixture(scope="module")
def planner() -> Iterator[Planner]:
    planner = Remembering(FastDownward())
    yield planner
    planner.close()


TASK = load_task("serve_breakfast")


def right_in(accuracy: float, repeat: float = 0.0) -> Calibration:
    """What is to be known of a noise model of some accuracy."""
    return Calibration(
        vlm="oracle",
        rows=5000,
        whole=Group(
            rows=5000, rates=AnswerRates(accuracy, 1 - accuracy, 0, 0), curve=Curve(slope=1)
        ),
        repeat_same_view=repeat,
        repeat_other_view=repeat,
    )


def run(
    planner: Planner, monitor: str = "belief", *, accuracy: float = 0.8, **changes: object
) -> tuple[Ended, list[Event], Trial]:
    settings: dict[str, object] = {
        "task": "serve_breakfast",
        "world": "symbolic",
        "vlm": f"oracle:{accuracy}",
        "monitor": monitor,
        "limits": Limits(actions=60),
        **changes,
    }
    told: dict[str, Any] = {
        "calibration": settings.pop("calibration", right_in(accuracy)),
        "experience": settings.pop("experience", None),
        "model": settings.pop("model", None),
    }
    writer = MemoryWriter()
    task = TASK if settings["task"] == "serve_breakfast" else None
    with Trial(configured(**settings), planner=planner, task=task, **told) as trial:
        return trial.run(writer), writer.events, trial


Plain = Callable[[float, int], tuple[Ended, list[Event]]]


@pytest.fixture(scope="module")
def plain(planner: Planner) -> Plain:
    """Trials with nothing but their accuracy and number set, each run once."""

    @cache
    def trial(accuracy: float, episode: int) -> tuple[Ended, list[Event]]:
        return run(planner, accuracy=accuracy, episode=episode)[:2]

    return trial


def test_it_completes_what_votes_do_not_and_asks_less(planner: Planner, plain: Plain) -> None:
    ours = [plain(0.8, n)[0] for n in range(30)]
    votes = [run(planner, "tpvqa:5", episode=n)[0] for n in range(30)]
    assert sum(bool(each.completed) for each in ours) >= 29
    assert sum(bool(each.completed) for each in votes) <= 28
    assert sum(each.questions for each in ours) < 0.7 * sum(each.questions for each in votes)


def test_the_same_seed_gives_the_same_trial(planner: Planner) -> None:
    one, other = run(planner, seed=4)[1], run(planner, seed=4)[1]
    assert story(one) == story(other)
    assert story(one) != story(run(planner, seed=5)[1])


def test_trials_that_share_an_action_model_decide_as_those_that_do_not(planner: Planner) -> None:
    model = FaultModel(TASK, load_world_file(find_task("serve_breakfast").world, TASK))
    shared = [run(planner, accuracy=0.7, episode=n, model=model) for n in range(4)]
    assert all(trial.monitor.belief.model is model for _, _, trial in shared)  # type: ignore[attr-defined]
    alone = [run(planner, accuracy=0.7, episode=n) for n in range(4)]
    models = [trial.monitor.belief.model for _, _, trial in alone]  # type: ignore[attr-defined]
    assert len({id(each) for each in models}) == len(models)
    assert [story(events) for _, events, _ in alone] == [story(events) for _, events, _ in shared]


def test_trials_in_several_threads_decide_as_trials_alone(planner: Planner, plain: Plain) -> None:
    def decided(episode: int) -> list[dict[str, object]]:
        return story(run(planner, accuracy=0.7, episode=episode)[1])

    alone = [story(plain(0.7, episode)[1]) for episode in range(8)]
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-5)  # so that threads take turns often
    try:
        with ThreadPoolExecutor(8) as threads:
            together = list(threads.map(decided, range(8)))
    finally:
        sys.setswitchinterval(before)
    assert together == alone


def test_dear_questions_are_not_asked_and_cheap_ones_are(planner: Planner) -> None:
    dear = [run(planner, "belief:question=500", episode=n)[0] for n in range(5)]
    assert all(each.questions == 0 and each.actions >= 6 for each in dear)
    cheap = [run(planner, "belief:question=0.001", episode=n)[0] for n in range(5)]
    usual = [run(planner, "belief:question=0.3", episode=n)[0] for n in range(5)]
    assert sum(e.questions for e in cheap) > sum(e.questions for e in usual) > 0


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("cost", ["action", "question", "look", "failure", "misreport"])
def test_what_costs_most_is_still_reckoned_with(planner: Planner, cost: str) -> None:
    ended, _, _ = run(planner, f"belief:{cost}=1e6")
    assert ended.because in ("goal", "gave up")


@pytest.mark.parametrize("free", ["question=0", "question=0:look=0"])
def test_questions_may_cost_nothing(planner: Planner, free: str) -> None:
    ended, _, _ = run(planner, f"belief:{free}")
    assert ended.completed
    assert ended.questions > 0


@pytest.mark.parametrize(
    ("budget", "counted"),
    [
        ("questions_per_trial=7", "questions"),
        ("looks_per_trial=4", "looks"),
    ],
)
def test_a_budget_for_the_trial_is_kept(planner: Planner, budget: str, counted: str) -> None:
    limit = int(budget.partition("=")[2])
    used = [getattr(run(planner, f"belief:{budget}", episode=n)[0], counted) for n in range(6)]
    assert max(used) == limit


@pytest.mark.parametrize(
    "budget",
    ["questions_per_trial=30", "looks_per_trial=20", "looks_per_step=0", "questions_per_trial=0"],
)
def test_once_a_budget_is_spent_it_goes_on_unseen_and_ends(planner: Planner, budget: str) -> None:
    several = [
        run(planner, f"belief:{budget}", limits=Limits(actions=600), episode=n)[0]
        for n in range(1, 5)
    ]
    assert all(each.actions < 150 for each in several)
    assert sum(bool(each.goal_holds) for each in several) >= 2


@pytest.mark.parametrize("what", ["questions", "looks"])
def test_a_budget_between_two_actions_is_kept(planner: Planner, what: str) -> None:
    _, events, _ = run(planner, f"belief:{what}_per_step=2")
    kind, most, count = ("asked" if what == "questions" else "observed"), 0, 0
    for event in events:
        count = 0 if event.kind == "acting" else count + (event.kind == kind)
        most = max(most, count)
    assert most == 2


def test_every_decision_explains_itself_from_the_numbers(plain: Plain) -> None:
    """The figures in a reason are those that are believed when it is decided."""
    told = 0
    for n in range(6):
        for event in plain(0.8, n)[1]:
            if not isinstance(event, Decided) or event.when == "before":
                continue
            assert event.reason
            believed = {f"{p:.2f}" for each in event.belief.values() for p in (each, 1 - each)}
            figures = set(re.findall(r"(\d\.\d\d) after", event.reason))
            assert figures <= believed, (event.reason, event.belief)
            told += len(figures)
    assert told > 12


def test_what_moved_against_its_own_answers_moved_by_others(plain: Plain) -> None:
    told = re.compile(r"(not )?[^;]*? (\d\.\d\d) → (\d\.\d\d) after ([a-z0-9 ]+)(, by what else)?")
    numbers = ("a", "two", "three", "four", "five", "six", "seven", "eight", "nine")
    against = 0

    def number(said: str) -> int:
        return numbers.index(said) + 1 if said in numbers else int(said)

    for n in range(30):
        for event in plain(0.7, n)[1]:
            if not isinstance(event, Decided) or event.when == "before":
                continue
            for denied, before, now, words, else_ in told.findall(event.reason):
                said = dict(each.split()[::-1] for each in words.split(" and "))
                yeses, noes = (
                    number(said.get(one) or said.get(many, "0"))
                    for one, many in (("yes", "yeses"), ("no", "noes"))
                )
                risen = (float(now) - float(before)) * (-1 if denied else 1)
                assert bool(else_) == (risen * (yeses - noes) < 0), event.reason
                against += bool(else_)
    assert against


def test_what_is_done_in_case_something_holds_is_told_from_what_is_done_as_it_holds(
    planner: Planner,
) -> None:
    told = re.compile(r"(?:back to|on to) [^;:]*?(: | in case )([^;]*)")
    seen = set[str]()
    for n in range(12):
        _, events, _ = run(planner, "belief", vlm="oracle:0.7:0:0.74", episode=n)
        for event in events:
            if isinstance(event, Decided):
                for since, facts in told.findall(event.reason):
                    figures = [float(each) for each in re.findall(r"\((\d\.\d\d)\)", facts)]
                    assert (since != ": ") == (min(figures, default=1.0) < 0.5), event.reason
                    seen.add(since)
    assert len(seen) == 2


def likely(event: Decided, literal: Literal) -> float:
    p = event.belief.get(literal.atom.pddl(), 1.0)
    return p if literal.positive else 1 - p


def test_what_is_done_again_probably_failed_and_what_ends_probably_holds(plain: Plain) -> None:
    kinds: set[str] = set()
    actions = {action.pddl(): action for action in TASK.ground_actions()}
    for n in range(12):
        for event in plain(0.7, n)[1]:
            if not isinstance(event, Decided) or event.when == "before":
                continue
            kinds.add(event.decision)
            if event.decision == "repeat":
                effects = actions[event.action].effects
                assert min(likely(event, each.literal) for each in effects) < 0.97
            elif event.decision == "done":
                assert min(likely(event, each) for each in literals(TASK.goal)) > 0.85
    assert kinds >= {"repeat", "replan", "go on", "done"}


def test_a_cheap_failure_is_no_reason_not_to_begin(planner: Planner) -> None:
    """A plan that costs more than a failed task is tried all the same."""
    ended, _, _ = run(planner, "belief:failure=1")
    assert ended.actions >= 6


def test_pictures_that_repeat_are_not_asked_again_and_again(planner: Planner) -> None:
    """The picture set has six pictures of a state; a noise model answers by the look."""
    pictures = run(planner, task="clean_dishes", world="images", vlm="embedded", calibration=None)
    assert pictures[0].completed
    asked: list[tuple[bytes, str]] = []
    for event in pictures[1]:
        if event.kind == "acting":
            asked.clear()
        elif event.kind == "observed":
            source = event.frames[0].source
        elif event.kind == "asked":
            pairs = [(source, question.text) for question in event.questions]
            assert not set(pairs) & set(asked)
            asked += pairs  # type: ignore[arg-type]
    noise = run(planner, task="clean_dishes", world="images", vlm="oracle:0.8")[0]
    assert noise.completed
    assert noise.questions < 300


def test_with_a_right_calibration_trust_stays_where_it_is_though_answers_repeat(
    planner: Planner,
) -> None:
    experience = None
    for episode in range(10):
        _, _, trial = run(
            planner,
            task="clean_dishes",
            vlm="oracle:0.8:0.5",
            calibration=right_in(0.8, 0.5),
            experience=experience,
            episode=episode,
        )
        experience = trial.experience
    assert isinstance(trial.monitor, BeliefMonitor)
    assert trial.monitor.trust is not None
    assert 0.7 < trial.monitor.trust.mean < 1.6


def test_considered_plans_are_marked_and_replans_are_not(planner: Planner) -> None:
    ended, events, _ = run(planner, accuracy=0.7, seed=2)
    plans = [event for event in events if isinstance(event, PlanMade)]
    followed = [event for event in plans if not event.considered]
    assert len(followed) == ended.replans + 1
    assert len(plans) > len(followed)


def test_only_what_the_plan_needs_is_asked_about(planner: Planner) -> None:
    _, events, _ = run(planner, seed=1)
    asked = {q.atom for event in events if isinstance(event, Asked) for q in event.questions}
    assert asked
    assert not [atom for atom in asked if "knife" in str(atom) or "apple" in str(atom)]


def test_a_person_who_is_not_there_is_asked_once(planner: Planner) -> None:
    _, events, _ = run(planner, "belief:person=0.01", accuracy=0.6)
    assert sum(isinstance(event, Asked) and event.person for event in events) == 1


class Bystander:
    """A person who sees what is true."""

    name = "bystander"

    def __init__(self) -> None:
        self.truth: TruthSource

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        return [Answer(question, truthful(question, self.truth.holds)) for question in questions]


def beside_a_person(planner: Planner, monitor: str) -> tuple[Ended, int]:
    """How a trial ended, and how often a person was asked."""
    bystander, writer = Bystander(), MemoryWriter()
    config = TrialConfig(
        task="serve_breakfast", world="symbolic", vlm="oracle:0.6", monitor=monitor
    )
    told = right_in(0.6)
    with Trial(config, planner=planner, task=TASK, person=bystander, calibration=told) as trial:
        bystander.truth = known_truth(trial.world)
        end = trial.run(writer)
    return end, sum(isinstance(event, Asked) and event.person for event in writer.events)


def test_a_person_who_answers_is_asked_instead_of_a_poor_vlm(planner: Planner) -> None:
    cheap, often = beside_a_person(planner, "belief:person=0.02")
    dear, never = beside_a_person(planner, "belief:person=1000")
    assert cheap.completed
    assert often > 3
    assert never == 0
    assert cheap.questions < 0.5 * dear.questions


class TwoViews(SymbolicWorld):
    """A world that can be looked at from the side, too."""

    def views(self) -> tuple[str, ...]:
        return ("front", "side")

    def observe(self, view: str | None = None) -> Observation:
        time = super().observe().time
        frame = Frame("camera", view or "front", f"picture at {time:g} s".encode())
        return Observation(time=time, frames={frame.view: frame})


class FromTheSide:
    """Sees what is true from the side, and nothing from the front."""

    name = "from-the-side"

    def __init__(self, truth: TruthSource):
        self.truth = truth

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        if "side" not in observation.frames:
            return [Answer(question, Reply.CANNOT_SEE) for question in questions]
        return [Answer(question, truthful(question, self.truth.holds)) for question in questions]


def test_what_cannot_be_seen_from_one_view_is_asked_from_another(planner: Planner) -> None:
    made: list[Trial] = []
    config = TrialConfig(task="serve_breakfast", world="symbolic", vlm="oracle")
    for views in (1, 2):
        simulation = Trial(config, planner=planner, task=TASK).simulation
        assert simulation is not None
        world = TwoViews(simulation)
        seen = world.views()[:views]
        monitor = BeliefMonitor(TASK, calibration=right_in(0.95), views=seen)
        trial = Trial(config, planner=planner, task=TASK)
        trial.monitor = monitor
        trial.parts = replace(trial.parts, world=world, vlm=FromTheSide(world.truth))
        made.append(trial)
    blind, seeing = (trial.run(MemoryWriter(resumable=False)) for trial in made)
    assert seeing.completed
    assert seeing.questions > 5
    assert blind.because == "gave up"


def test_the_limits_of_the_trial_are_known(planner: Planner) -> None:
    """Nothing ever succeeds: the robot gives up rather than run into a limit."""
    limits = Limits(repeats=2, replans=1, actions=40)
    ended, events, _ = run(planner, accuracy=0.95, failure=1.0, limits=limits)
    assert ended.because == "gave up"
    assert ended.replans <= 1
    attempts = [event.attempt for event in events if isinstance(event, Acting)]
    assert max(attempts) == 2


@pytest.mark.parametrize(
    ("spec", "says"),
    [
        ("belief:price=3", "price"),
        ("belief:question=much", "question"),
        ("belief:question=-1", "question"),
        *(
            (f"belief:{cost}=1e308", f"{cost}: .*1000000")
            for cost in ("action", "question", "look", "replan", "person", "failure", "misreport")
        ),
        ("belief:failure_rate=2", "between 0 and 1"),
        ("belief:without=luck", "consistency, relevance"),
    ],
)
def test_what_is_not_understood_is_said(planner: Planner, spec: str, says: str) -> None:
    with pytest.raises(PluginError, match=says):
        run(planner, spec)


@pytest.mark.parametrize("part", ["consistency", "relevance", "calibration", "model", "learning"])
def test_each_part_can_be_left_out(planner: Planner, plain: Plain, part: str) -> None:
    spec = f"belief:without={part}"
    ended, events, _ = run(planner, spec)
    assert ended.actions > 0
    assert story(events) != story(plain(0.8, 0)[1])


@pytest.mark.parametrize("spec", ["belief", "belief:without=relevance"])
def test_a_vlm_that_never_answers_keeps_nothing_going(planner: Planner, spec: str) -> None:
    config = TrialConfig(task="clean_dishes", world="symbolic", vlm="oracle", monitor=spec)
    with Trial(config, planner=planner) as trial:
        silent = FromTheSide(known_truth(trial.world))
        trial.parts = replace(trial.parts, vlm=silent)
        ended = trial.run(MemoryWriter(resumable=False))
    assert ended.actions > 0
    assert ended.questions < 1000


def test_it_learns_from_trial_to_trial_that_the_vlm_is_worse_than_it_was_told(
    planner: Planner,
) -> None:
    experience, means = None, []
    for episode in range(12):
        _, _, trial = run(
            planner,
            accuracy=0.7,
            calibration=right_in(0.9).model_copy(
                update={"whole": Group(rows=5000, rates=AnswerRates(0.9, 0.1, 0, 0))}
            ),
            experience=experience,
            episode=episode,
        )
        assert isinstance(trial.monitor, BeliefMonitor)
        experience = trial.experience
        assert trial.monitor.trust is not None
        means.append(trial.monitor.trust.mean)
    assert experience is not None
    assert experience.trials == 12
    # An answer of log odds 2.2 that is right in 0.7 of all cases is worth 0.85: a factor of 0.39.
    assert 0.25 < means[-1] < 0.55


def test_what_is_found_done_is_not_done_again(planner: Planner) -> None:
    """Luck: the fridge is open though nobody opened it, and an answer says so."""
    config = configured(
        task="eat_apple", world="symbolic", vlm="oracle:0.95", failure=0.0, monitor="belief"
    )
    with Trial(config, planner=planner, calibration=right_in(0.95)) as trial:
        assert isinstance(trial.monitor, BeliefMonitor)
        assert trial.simulation is not None
        opening = trial.task.action("open", ["fridge"])
        trial.simulation.state = trial.task.apply(trial.task.init, opening)
        (opened,) = trial.simulation.state - trial.task.init
        question = trial.book.fact(Literal(opened))
        for look in range(-4, 0):
            trial.monitor.evidence.take(
                question, Answer(question, Reply.YES, p_yes=0.95), look, None
            )
        writer = MemoryWriter()
        ended = trial.run(writer)
    assert ended.completed
    assert not any(e.kind == "acting" and e.action.name == "open" for e in writer.events)


@pytest.mark.parametrize("budget", ["questions_per_trial=0", "looks_per_trial=0"])
def test_a_person_is_asked_where_the_vlm_may_not_be(planner: Planner, budget: str) -> None:
    end, often = beside_a_person(planner, f"belief:person=0.5:{budget}")
    assert end.completed
    assert end.actions < 20
    assert often > 3


def asked_again_after_a_yes(events: Sequence[Event], predicate: str) -> int:
    """How often a question about a predicate was asked again before the next action."""
    affirmed: set[str] = set()
    again, asked = 0, None
    for event in events:
        if isinstance(event, Acting):
            affirmed.clear()
        elif isinstance(event, Asked):
            asked = event
            again += sum((each.atom or "") in affirmed for each in event.questions)
        elif isinstance(event, Answered) and asked is not None:
            affirmed |= {
                question.atom or ""
                for question, answer in zip(asked.questions, event.answers, strict=True)
                if answer.reply is Reply.YES and (question.atom or "").startswith(f"({predicate} ")
            }
    return again


def unsure_answers(seed: int) -> Answerer:
    draws = Random(seed)
    return lambda question: Reply.YES if draws.random() < 0.7 else Reply.NO


def test_what_a_picture_may_still_show_is_not_asked_again_once_affirmed(
    planner: Planner, tmp_path: Path
) -> None:
    """A second yes would say nothing more of where the robot is."""
    given = find_task("clean_dishes").questions
    assert given is not None
    shown = tmp_path / "questions.yaml"
    shown.write_text(given.read_text() + '\nstill_shown: ["(near ?x)"]\n')

    def again(questions: Path) -> int:
        told = 0
        for episode in range(3):
            config = configured(
                task="clean_dishes",
                world="images",
                monitor="belief",
                questions=str(questions),
                limits=Limits(actions=10),
                episode=episode,
            )
            unsure = ScriptedVLM(unsure_answers(episode))
            writer = MemoryWriter()
            with Trial(config, planner=planner, vlm=unsure) as trial:
                trial.run(writer)
            told += asked_again_after_a_yes(writer.events, "near")
        return told

    assert again(shown) == 0 < again(Path(str(given)))
