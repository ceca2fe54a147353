"""What users are told before anything runs."""

import shlex
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tpvqa.assembly import Trial
    from tpvqa.belief.calibrating.calibration import Calibration
    from tpvqa.belief.filtering.priors import Priors
    from tpvqa.config import TrialConfig
    from tpvqa.errors import AnswerError
    from tpvqa.pddl import Task
    from tpvqa.questions import QuestionBook
    from tpvqa.tasks import TaskFiles


def about_own_files(
    tasks: "Iterable[TaskFiles]", *, questions: object, world_file: object
) -> list[str]:
    """What to know of the files of one's own tasks that are used without having been named.

    Args:
        tasks: The tasks' files.
        questions: What was named; None for nothing.
        world_file: The same.
    """
    found: dict[Path, str] = {}
    for files in tasks:
        if questions is None and files.questions is not None:
            found[files.questions] = "--questions"
        if world_file is None and files.world is not None:
            found[files.world] = "--world-file"
    return [f"{path} is used; name another with {option}" for path, option in found.items()]


def about_vlm(config: "TrialConfig", vlm: str) -> list[str]:
    """What to know of a VLM that nobody has named, on a task of one's own."""
    if vlm != "embedded" or config.vlm.spec is not None or config.task.name is not None:
        return []
    return [
        "the embedded network answers, which knows the household's ten things and no words for "
        "others; name a VLM with --vlm, e.g. openai:MODEL"
    ]


def about_answers(vlm: object) -> list[str]:
    """How many answers of a trial came from the file of recorded ones."""
    from tpvqa.vlm.capabilities import StandsIn

    if not isinstance(vlm, StandsIn):
        return []
    from tpvqa.vlm.kept import KeptVLM

    if not isinstance(vlm, KeptVLM):
        return []
    return [f"{vlm.given} answers are from {vlm.file.path}, {vlm.asked} were asked"]


def about_words(book: "QuestionBook") -> list[str]:
    """What to know of a task's questions; the fallbacks are counted, not listed."""
    if len(book.fallbacks) < 2:
        return book.notices
    others = [notice for notice in book.notices if notice not in book.fallbacks]
    return [
        f"{len(book.fallbacks)} predicates and actions are put into words by their names in the "
        "PDDL; `tpvqa questions` lists them, and a questions file gives better ones",
        *others,
    ]


def about_start(task: "Task", priors: "Priors | None" = None, monitor: object = None) -> list[str]:
    """What to know where it is not sure how the world is at first.

    Args:
        task: The task.
        priors: What a trial is told of it besides.
        monitor: The trial's monitor; None where there is only a plan.
    """
    from tpvqa.monitors.capabilities import LooksFirst

    open_facts = len(task.left_open)
    if monitor is None and open_facts:
        facts = "1 fact" if open_facts == 1 else f"{open_facts} facts"
        return [
            f"the problem leaves {facts} open; the plan is one from a state that may be the case "
            "(--from-state names another)"
        ]
    told = priors is not None and (priors.opens or priors.elsewhere)
    if isinstance(monitor, LooksFirst) or monitor is None or not (open_facts or told):
        return []
    return [
        "this monitor knows no probabilities: what is not known at first, it is told as if it were "
        "known; --monitor belief weighs it"
    ]


def about_said(trial: "Trial") -> Iterator[str]:
    """What to know of files of questions and of priors that say nothing, or something in vain."""
    from tpvqa.belief.filtering.remarks_on_priors import remarks
    from tpvqa.errors import QuestionsError
    from tpvqa.yaml_places import read_yaml

    questions, priors = trial.questions, trial.config.start.priors
    if questions is not None and read_yaml(Path(questions), QuestionsError) is None:
        yield f"{questions}: the file is empty; `tpvqa questions --draft` writes one to edit"
    if priors is not None:
        for each in remarks(trial.task, trial.priors, trial.rules.undo):
            line = "" if each.line is None else f":{each.line}"
            yield f"{priors}{line}: {each.says}. {each.remedy}"


def about_calibration(
    vlm: str, calibration: "Calibration | None", task: "Task | None" = None
) -> list[str]:
    """What to know of what a VLM's answers are taken to be worth.

    Args:
        vlm: Specification of the VLM.
        calibration: What the monitor is told; None for nothing.
        task: What is asked about.
    """
    notices = []
    if calibration is None and vlm != "oracle":  # which is always right
        notices.append(
            f"there is no calibration of {vlm}: its answers are taken to be right in 0.85. "
            f"Calibrated, it is asked less: `tpvqa calibrate --vlm {vlm} …`"
        )
    if calibration is not None and calibration.vlm not in ("", vlm):
        notices.append(f"the calibration was learnt of {calibration.vlm}, and this VLM is {vlm}")
    if calibration is not None and task is not None:
        told = {group.predicate for group in calibration.groups if group.predicate}
        here = {*task.predicates, *(schema.name for schema in task.schemas)}
        if told and told.isdisjoint(here):
            notices.append(
                f"the calibration was learnt of another domain ({', '.join(sorted(told)[:3])} …): "
                "of each question it tells what it knows of all"
            )
    return notices


def about_prices(config: "TrialConfig") -> list[str]:
    """What to know of a price where only one of the two is named."""
    named = {
        "--price-prompt": config.vlm.price_prompt,
        "--price-completion": config.vlm.price_completion,
    }
    lacking = [option for option, price in named.items() if price is None]
    if len(lacking) != 1:
        return []
    return [f"{lacking[0]} is not given: its tokens are counted as costing nothing"]


def lost_midway(error: "AnswerError", folder: Path, config: "TrialConfig") -> "AnswerError":
    """The error of a VLM that can be asked no more, with the command that goes on later.

    Args:
        error: Why it cannot be asked.
        folder: The episode.
        config: Of the trial.
    """
    from tpvqa.errors import AnswerError, pasted

    resumed = f"tpvqa resume {pasted(folder)}"
    if config.vlm.base_url is not None:
        resumed += f" --base-url {shlex.quote(config.vlm.base_url)}"
    return AnswerError(
        f"{error}\nWhat was done until then is in {folder}. Once the VLM can be asked again, go on "
        f"with:\n{resumed}"
    )
