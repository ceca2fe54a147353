"""`tpvqa questions` and `tpvqa ask`."""

import json
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, NoReturn

import typer

from tpvqa.cli.options import ANSWERING, task_config, trial_options
from tpvqa.cli.plan import (
    CRASHED,
    TIMED_OUT,
    UNSOLVABLE,
    Domain,
    OwnProblem,
    PlannerName,
    Problem,
    Task,
)
from tpvqa.cli.saying import cell, tell
from tpvqa.config.layers import Layer, settings
from tpvqa.spelling import plain

if TYPE_CHECKING:
    from tpvqa.config import TaskConfig
    from tpvqa.pddl import Action
    from tpvqa.pddl import Literal as FactLiteral
    from tpvqa.pddl import Task as LoadedTask
    from tpvqa.questions import Question, QuestionBook
    from tpvqa.vlm import Answer

_PLAN_EXIT = (
    "Exit codes: 0 printed, 2 bad input, 3 the task has no plan, 4 planning timed out, "
    "5 the planner crashed."
)


def register(app: typer.Typer) -> None:
    """Add the commands."""
    app.command(epilog=_PLAN_EXIT)(questions)
    app.command(epilog="Exit codes: 0 asked, 2 the VLM or a picture cannot be used.")(ask)


def questions(
    task: Task = None,
    problem_file: Problem = None,
    *,
    domain: Domain = None,
    problem: OwnProblem = None,
    questions_file: Annotated[
        Path | None,
        typer.Option(
            "--questions",
            help="Questions for your domain. Default: the questions.yaml beside it, if there is "
            "one, else fallbacks.",
        ),
    ] = None,
    planner: PlannerName = None,
    timeout: Annotated[
        float,
        typer.Option(
            help="Seconds for grounding, and for planning; inf for no limit.",
            min=0.001,
        ),
    ] = 60.0,
    wording: Annotated[
        Literal["usual", "paper"],
        typer.Option(help="How whole actions are asked about: paper is without articles."),
    ] = "usual",
    drafted: Annotated[
        bool,
        typer.Option(
            "--draft",
            help="Write a questions file to edit, drafted from the names in the PDDL, instead: "
            "questions.yaml beside the problem, or --questions.",
        ),
    ] = False,
    force: Annotated[
        bool, typer.Option("--force", help="With --draft: write over a file that is there.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Print every question of a task's plan, action by action, for each way of asking."""
    from tpvqa.cli.drafting import write_draft
    from tpvqa.drivers.plugged import planned
    from tpvqa.errors import GroundingTimedOut
    from tpvqa.planning import Crashed, Plan, TimedOut, Unfit, Unsolvable
    from tpvqa.planning.making import make_planner

    try:
        if drafted:
            wanted, _ = task_config(task, problem_file, domain, problem)
            write_draft(wanted, questions_file, timeout=timeout, force=force, as_json=as_json)
            return
        wanted, notes = task_config(task, problem_file, domain, problem, questions_file)
        loaded, book = _load(wanted, timeout)
    except GroundingTimedOut as error:
        _no_questions(str(error.by("--timeout")), TIMED_OUT)
    book = book.worded(wording)
    chosen = make_planner("fast-downward" if planner is None else planner)
    try:
        result = planned(chosen, loaded, timeout=timeout)
    finally:
        chosen.close()
    match result:
        case Plan(actions):
            pass
        case Unsolvable(reason):
            _no_questions(f"the task has no plan: {reason}", UNSOLVABLE)
        case TimedOut(limit):
            _no_questions(
                f"planning took more than {limit:g} s; give it more by --timeout", TIMED_OUT
            )
        case Unfit(reason, by):
            _no_questions(f"the task cannot be planned with {by}: {reason}", 2)
        case Crashed(reason):
            _no_questions(f"the planner crashed: {reason}", CRASHED)
    steps = list(_steps(loaded, book, actions))
    for notice in () if as_json else (*notes, *book.notices):
        tell(f"note: {notice}", error=True)
    if as_json:
        _print_json(loaded, book, steps)
    elif sys.stdout.isatty():
        _print_table(book, steps)
    else:
        _print_lines(book, steps)


@trial_options(*(each.key for each in settings() if each.key not in ANSWERING), file=False)
def ask(
    image: Annotated[Path, typer.Argument(help="A picture.")],
    question: Annotated[list[str], typer.Argument(help="Questions with the answer yes or no.")],
    *,
    layers: Sequence[Layer],
    vlm: Annotated[
        str | None,
        typer.Option(help="embedded (the default), openai:MODEL, hf:MODEL or a plug-in."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Ask about a picture: prints each answer and P(yes)."""
    from tpvqa.assembly.answering import vlm_with_answers
    from tpvqa.config.layers import combined
    from tpvqa.defaults import default_vlm
    from tpvqa.errors import TpvqaError
    from tpvqa.pddl import Atom
    from tpvqa.plugins import Closing
    from tpvqa.questions import FactQuestion, Way
    from tpvqa.vlm.pictures import observe_file
    from tpvqa.vlm.sight import ask_seeing

    if not all(text.strip() for text in question):
        raise TpvqaError('A question is empty. Write for example "Is the fridge open?"')
    observation = observe_file(image)
    model = vlm_with_answers(vlm or default_vlm(), combined(layers))
    # A VLM that looks at pictures goes by the words alone.
    asked = [FactQuestion(text, Way.PRECONDITION, Atom("asked")) for text in question]
    try:
        answers = ask_seeing(model, observation, asked)
    finally:
        if isinstance(model, Closing):
            model.close()
    if as_json:
        rows = [_answer_as_json(answer) for answer in answers]
        print(json.dumps({"image": str(image), "vlm": model.name, "answers": rows}, indent=1))
    else:
        for answer in answers:
            tell(_answer_line(answer))


def _load(wanted: "TaskConfig", timeout: float) -> "tuple[LoadedTask, QuestionBook]":
    from tpvqa.assembly.reach import asking
    from tpvqa.belief.filtering.priors import Priors
    from tpvqa.pddl import load_task
    from tpvqa.questions import QuestionBook
    from tpvqa.tasks import find_task
    from tpvqa.worlds.world_file import load_world_file

    questions: str | Path | None = wanted.questions
    world: str | Path | None = wanted.world_file
    if wanted.name is not None:
        loaded = load_task(wanted.name, timeout=timeout)
        files = find_task(wanted.name)
        questions, world = questions or files.questions, world or files.world
    else:
        loaded = load_task(wanted.domain or "", wanted.problem, timeout=timeout)
    book = QuestionBook.load(questions, loaded)
    return loaded, asking(book, loaded, load_world_file(world and Path(world), loaded), Priors())


def _no_questions(why: str, code: int) -> NoReturn:
    tell(f"error: {why}", error=True)
    raise typer.Exit(code)


def _steps(
    task: "LoadedTask", book: "QuestionBook", plan: "tuple[Action, ...]"
) -> "Iterator[tuple[Action, list[Question]]]":
    """Each action of a plan with its questions, before those after it."""
    state = task.init
    for action in plan:
        asked: list[Question] = [*book.preconditions(action, state), book.possible(action)]
        asked += [*book.effects(action, state), book.successful(action), book.did(action)]
        yield action, asked
        state = task.apply(state, action)


def _print_json(
    task: "LoadedTask", book: "QuestionBook", steps: "list[tuple[Action, list[Question]]]"
) -> None:
    from tpvqa.questions import FactQuestion

    actions: list[dict[str, Any]] = []
    state = task.init
    for action, asked in steps:
        entry = {
            "name": action.name,
            "arguments": list(action.arguments),
            "say": book.say(action),
            "done": book.done(action),
            "questions": [
                {
                    "way": question.way.value,
                    "text": question.text,
                    "expected": "yes" if question.expected else "no",
                    "fact": question.atom.pddl() if isinstance(question, FactQuestion) else None,
                }
                for question in asked
            ],
            "not_asked": [
                {"fact": _pddl(literal), "because": reason}
                for literal, reason in book.unasked(action, state).items()
            ],
        }
        actions.append(entry)
        state = task.apply(state, action)
    print(json.dumps({"task": task.name, "actions": actions, "notices": book.notices}, indent=1))


def _pddl(literal: "FactLiteral") -> str:
    fact = literal.atom.pddl()
    return fact if literal.positive else f"(not {fact})"


def _print_lines(book: "QuestionBook", steps: "list[tuple[Action, list[Question]]]") -> None:
    for number, (action, asked) in enumerate(steps, start=1):
        tell(f"{number}. {book.say(action)}")
        for question in asked:
            answer = "yes" if question.expected else "no"
            tell(f"   {question.way.value}: {question.text} {answer}")


def _print_table(book: "QuestionBook", steps: "list[tuple[Action, list[Question]]]") -> None:
    from rich import box
    from rich.table import Table
    from rich.text import Text

    from tpvqa.cli.consoles import ResultConsole

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for heading in ("Action", "Way of asking", "Question", "Expected"):
        table.add_column(heading, no_wrap=heading == "Way of asking")
    for number, (action, asked) in enumerate(steps, start=1):
        for at, question in enumerate(asked):
            answer = Text("yes", "green") if question.expected else Text("no", "red")
            said = Text(f"{number}. {plain(book.say(action))}" if at == 0 else "", "bold")
            last = at == len(asked) - 1
            table.add_row(said, question.way.value, cell(question.text), answer, end_section=last)
    ResultConsole().print(table)


def _answer_as_json(answer: "Answer") -> dict[str, Any]:
    return {
        "question": answer.question.text,
        "reply": answer.reply.value,
        "p_yes": answer.p_yes,
        "p_cannot_see": answer.p_cannot_see,
        "leftover": answer.leftover,
        "source": answer.source,
        "text": answer.text,
        "seconds": round(answer.seconds, 4),
    }


def _answer_line(answer: "Answer") -> str:
    if answer.p_yes is None:
        detail = f"no probability: {answer.text}" if answer.text else "no probability"
    else:
        detail = f"P(yes) = {answer.p_yes:.3f}"
        if answer.p_cannot_see is not None:
            detail += f", P(cannot see) = {answer.p_cannot_see:.3f}"
    return f"{answer.question.text} {answer.reply.value} ({detail})"
