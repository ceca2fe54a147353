"""All that is wrong with a domain, a problem, its questions, its world file and its priors."""

from collections.abc import Iterator
from pathlib import Path

from tpvqa.checking import possible, wordings, world
from tpvqa.checking.contradicting import of_effects
from tpvqa.checking.finding import Finding, Severity, of_error
from tpvqa.checking.idle_effects import of_idle_effects
from tpvqa.checking.left_open import of_left_open
from tpvqa.checking.opposites import of_opposites
from tpvqa.checking.priors import of_priors
from tpvqa.checking.seeing import Telling
from tpvqa.checking.unused_objects import of_objects
from tpvqa.drafting import words
from tpvqa.errors import PDDLError, QuestionsError, WorldFileError
from tpvqa.pddl import Task, load_task
from tpvqa.planning import Planner
from tpvqa.questions import QuestionBook
from tpvqa.questions.wordings import Wordings, read_wordings
from tpvqa.tasks import QUESTIONS, WORLD
from tpvqa.worlds.world_file import WorldRules, load_world_file


def check(
    domain: Path,
    problem: Path,
    *,
    questions: Path | None,
    world_file: Path | None,
    priors: Path | None = None,
    start: str = "known",
    planner: Planner,
    timeout: float = 60.0,
) -> list[Finding]:
    """Find what does not fit, errors first.

    Args:
        domain: The domain.
        problem: The problem.
        questions: The questions file; None for none.
        world_file: The world file; None for none.
        priors: The file of priors; None for none.
        start: What is known at first where they are used: "known" or "unknown".
        planner: Says whether the goal can be reached.
        timeout: Seconds for grounding, and for planning.

    Raises:
        GroundingTimedOut: Grounding took too long.
        PlannerError: Grounding failed.
        PDDLError: The domain or the problem is no file that can be read.
    """
    try:
        task = load_task(domain, problem, timeout=timeout)
    except PDDLError as error:
        if not (domain.is_file() and problem.is_file()):
            raise
        return [of_error("pddl", error)]
    found = list(_findings(task, questions, world_file, (priors, start), planner, timeout))
    order = list(Severity)
    return sorted(found, key=lambda each: order.index(each.severity))


def _findings(
    task: Task,
    questions: Path | None,
    world_file: Path | None,
    told: tuple[Path | None, str],
    planner: Planner,
    timeout: float,
) -> Iterator[Finding]:
    folder = Path("") if task.problem_path is None else task.problem_path.parent
    into = str(questions or folder / QUESTIONS)
    given, wrong = Wordings(), list[QuestionsError]()
    drafted = None
    try:
        if questions is not None:
            given, drafted = read_wordings(questions, task, wrong=wrong), questions
    except QuestionsError as error:
        wrong.append(error)
    yield from (of_error("questions", error) for error in wrong)
    rules, unread = WorldRules(), False
    try:
        rules = load_world_file(world_file, task)
    except WorldFileError as error:
        unread = True
        yield of_error("world", error)
    undone = frozenset(task.predicates) if unread else _undone(rules)
    rules_into = str(world_file or folder / WORLD)
    yield from possible.of_goal(task, planner, timeout)
    yield from possible.of_metric(task)
    yield from possible.of_actions(task, undone)
    yield from of_idle_effects(task, undone)
    yield from possible.of_predicates(task)
    if not (wrong or unread or told[0] or told[1] == "unknown"):  # these may speak of any object
        yield from of_objects(task, given, world_file)
    yield from of_effects(task)
    yield from of_left_open(task)
    yield from wordings.in_vain(task, given, questions)
    yield from wordings.doubled(given, questions)
    yield from wordings.still_marked(drafted)
    if questions is None:
        yield Finding(
            "no-questions",
            Severity.WARNING,
            "there is no questions file, so that all is asked in words made of the names",
            "`tpvqa questions --draft` writes one to edit.",
        )
    elif not wrong:
        if given == Wordings():
            yield Finding(
                "empty-questions",
                Severity.WARNING,
                "the file says nothing, so that all is asked in words made of the names",
                "`tpvqa questions --draft` writes one to edit.",
                str(questions),
            )
        yield from wordings.without_words(task, given, words(task), into)
    book = QuestionBook(task, given)
    yield from wordings.alike(task, book, questions)
    yield from of_opposites(task, book, into)
    if not unread:  # else what is missed may stand in it
        yield from Telling(task, book, rules, into=rules_into).findings()
        yield from world.of_rules(task, rules, world_file)
        yield from world.not_taken(task, rules, rules_into)
    yield from of_priors(task, told[0], rules, told[1])


def _undone(rules: WorldRules) -> frozenset[str]:
    """The predicates of what a disturbance can bring about."""
    return frozenset(p.predicate for rule in rules.undo for o in rule.outcomes for p in o.add)
