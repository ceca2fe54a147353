"""`tpvqa calibrate`: learn what a VLM's answers are worth."""

import json
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tpvqa.cli.calibration_table import draw, plain, print_calibration
from tpvqa.cli.notices import about_own_files
from tpvqa.cli.options import ANSWERING, trial_options
from tpvqa.cli.outputs import all_or_none, named_by, see_free, see_unread
from tpvqa.cli.picture_sets import opened_set
from tpvqa.cli.saying import tell
from tpvqa.config.layers import Key, Layer, combined

if TYPE_CHECKING:
    from tpvqa.belief import LabelledAnswer
    from tpvqa.belief.learning.experience import Experience
    from tpvqa.bench.labelled_episodes import Labelled
    from tpvqa.cli.progress import CountBar
    from tpvqa.config import TrialConfig
    from tpvqa.questions import QuestionBook
    from tpvqa.worlds.pictures import PictureSet
    from tpvqa.worlds.pictures.manifest import Picture

_EXIT = "Exit codes: 0 written, 2 bad input, 6 could not be written, 130 interrupted."
_SOURCES = (
    "Give one source of labelled answers: folders of recorded episodes, --pictures shipped (or a "
    "folder of such a set), or --trials N"
)


_ELSEWHERE: tuple[Key, ...] = (
    *(("task", name) for name in ("name", "domain", "problem", "questions", "world_file")),
    *(("world", name) for name in ("spec", "pictures")),
    *(("monitor", name) for name in ("spec", "calibration", "experience", "risk", "risk_file")),
    ("vlm", "spec"),
    ("episode",),
)
"""Settings of a trial for which there are options of another meaning here, or none."""
_SHORT = Layer({("limits", "actions"): 60}, {("limits", "actions"): "default"})
"""Trials that teach need not be long …"""
_WHOLE = Layer({("limits", "actions"): "4x"}, {("limits", "actions"): "default"})
"""… but a survey, which does every action of the plan twice at most, comes to its end."""
_MORE = "Run more trials."
_SURVEYS = (
    "Run more trials, or --monitor survey:3, which goes on whatever is answered and so comes to "
    "the last steps."
)


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command(epilog=_EXIT)(calibrate)


@trial_options(*_ELSEWHERE, defaults=_SHORT)
def calibrate(
    episodes: Annotated[
        list[Path] | None,
        typer.Argument(
            help="Folders of recorded episodes: labelled ones (`tpvqa label`), or in a simulated "
            "world; of others it is inferred what was right."
        ),
    ] = None,
    *,
    layers: Sequence[Layer],
    vlm: Annotated[
        str | None,
        typer.Option(
            help="Whose answers. Default: embedded; with episodes, whoever answered in them."
        ),
    ] = None,
    out: Annotated[Path, typer.Option(help="The file to write.")] = Path("calibration.json"),
    pictures: Annotated[
        str | None,
        typer.Option(help="Ask about labelled pictures: 'shipped', or the folder of a set."),
    ] = None,
    hidden: Annotated[
        bool,
        typer.Option("--hidden", help="With --pictures: ask about what is hidden in them, too."),
    ] = False,
    trials: Annotated[
        int | None, typer.Option(help="Run so many trials of every task.", min=1)
    ] = None,
    domain: Annotated[
        Path | None,
        typer.Option(help="With --pictures or --trials: your own domain, or a logic program."),
    ] = None,
    problem: Annotated[
        list[Path] | None,
        typer.Option(
            help="With --domain: your own problem; with --trials also several, or a folder."
        ),
    ] = None,
    questions: Annotated[
        Path | None,
        typer.Option(help="With --domain: your questions. Default: the questions.yaml beside it."),
    ] = None,
    world_file: Annotated[
        Path | None,
        typer.Option(
            help="With --trials and --domain: what disturbances undo, and what is sensed."
        ),
    ] = None,
    tasks: Annotated[
        str | None,
        typer.Option(
            help="With --trials: shipped tasks, with commas. Default without --domain: those of "
            "the household, if it is installed."
        ),
    ] = None,
    world: Annotated[
        str | None,
        typer.Option(
            help="With --trials. Default: the task's own for VLMs that look, symbolic for noise "
            "models."
        ),
    ] = None,
    monitor: Annotated[
        str | None,
        typer.Option(
            help="With --trials: who asks; tpvqa:K looks K times. Default: survey:8:twice for "
            "noise models, which goes on whatever is answered, else tpvqa."
        ),
    ] = None,
    experience: Annotated[
        Path | None,
        typer.Option(
            help="With EPISODES: also write how often actions failed, for `tpvqa run --experience`."
        ),
    ] = None,
    curves: Annotated[
        Path | None,
        typer.Option(help="Picture of reliability before and after. Default: beside the file."),
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Write over files that are there.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the figures as JSON.")] = False,
) -> None:
    """Learn from labelled answers what a VLM's answers are worth, and show how reliable they are.

    "After" is always of answers that the calibration in question was not learnt from: each half
    of the trials is judged by what the other half taught.
    """
    from tpvqa.belief.calibrating.fitting import fit
    from tpvqa.belief.calibrating.held_out import held_out
    from tpvqa.belief.calibrating.own_words import OwnWords
    from tpvqa.bench.labelled_trials import label_trials
    from tpvqa.bench.own_task import own_tasks
    from tpvqa.bench.recorded_faults import experience_from
    from tpvqa.bench.reliability import doubts, lines, one_sided
    from tpvqa.defaults import default_vlm, labelling_monitor
    from tpvqa.errors import TpvqaError
    from tpvqa.vlm.making import in_full

    given_keys = {key for layer in layers if layer is not _SHORT for key in layer.values}
    if trials is None and given_keys - (set(ANSWERING) if pictures is not None else set()):
        raise TpvqaError("How trials are run is for --trials N; leave it out otherwise.")
    given = [bool(episodes), pictures is not None, trials is not None]
    if sum(given) != 1:
        raise TpvqaError(f"{_SOURCES}; {'none' if not any(given) else 'several'} was given.")
    if experience is not None and not episodes:
        raise TpvqaError("--experience counts the faults of recorded episodes: name their folders.")
    domain, problems = _own(domain, problem or [])
    if any((domain, problems, questions, world_file)):
        _check_own(domain, problems, world_file, pictures=pictures is not None, trials=trials)
    own = (domain, problems[0] if problems else None, questions)
    if not out.name:
        raise TpvqaError(f"{out} is a folder; name a file with --out")
    image = curves or out.with_suffix(".png")
    written = [("--out", out), ("--curves", image)]
    written += [("--experience", experience)] if experience else []
    own_files = (file for each in problems for file in (each, *each.glob("*.pddl")))
    read = (*(episodes or ()), domain, *own_files, questions, world_file, named_by(vlm))
    _check(written, read, force=force)
    surveyed = False
    found: Labelled | None = None
    learned: Experience | None = None
    heard = OwnWords()
    if episodes:
        found = _from_episodes(episodes, vlm)
        name, rows = found.vlm, found.plain
        learned = experience_from(found.own.acts) if experience is not None else None
    elif pictures is not None:
        config = combined(layers)
        opened = opened_set(pictures, books := own_book(*own))
        for option, path in written:
            see_unread(path, option, opened.paths)
        asked = vlm or default_vlm()
        name, rows = _from_pictures(asked, config, opened, books, hidden=hidden)
    else:
        assert trials is not None
        name = in_full(vlm or default_vlm(pictures=not problems))
        monitor = labelling_monitor(name) if monitor is None else monitor
        surveyed = monitor.partition(":")[0] == "survey"
        if surveyed:
            layers = [_WHOLE if layer is _SHORT else layer for layer in layers]
        tasks_of_own = own_tasks(
            problems, domain=domain, questions=questions, world_file=world_file
        )
        files = [each.origin for each in tasks_of_own.values()]
        for notice in about_own_files(files, questions=questions, world_file=world_file):
            tell(f"note: {notice}", error=True)
        with _progress("trials") as bar:
            rows = label_trials(
                name,
                trials,
                tasks=_named(tasks, own=bool(problems)),
                own=tasks_of_own,
                world=world,
                monitor=monitor,
                common=combined(layers),
                heard=heard,
                progress=bar,
            )
    chosen_looks = pictures is None and not surveyed
    if found:
        calibration = found.fit()
    else:
        calibration = fit(rows, name, chosen_looks=chosen_looks).hearing(heard)
    judged = held_out(rows, name, chosen_looks=chosen_looks)
    table = lines(rows, judged, chosen_looks=chosen_looks)
    besides = bool(calibration.faults or calibration.sensors or calibration.skills)
    remedy = "" if trials is None else _MORE if surveyed else _SURVEYS
    doubted = (*one_sided(table, remedy), *doubts(table[-1], besides=besides))
    told = (*calibration.notices, *doubted)
    calibration = calibration.model_copy(update={"notices": told})
    with all_or_none(path for _, path in written):
        calibration.save(out)
        if learned is not None and experience is not None:
            learned.save(experience)
        draw(image, judged, name)
    if as_json:
        typer.echo(json.dumps(plain(calibration, table, out, image), indent=1))
    else:
        print_calibration(calibration, table)
        tell(f"wrote {out} and {image}")


def _check(
    files: Sequence[tuple[str, Path]], read: Sequence[Path | str | None], *, force: bool
) -> None:
    """What would end the work at its end is told before it.

    Args:
        files: What is to be written, by the option that names it.
        read: What is read, and is never written over.
        force: Whether what is there may be written over.
    """
    from tpvqa.belief.calibrating.platt import regression
    from tpvqa.bench.style import styled_pyplot
    from tpvqa.errors import CalibrationError
    from tpvqa.files import see_writable

    regression()
    styled_pyplot()
    known: dict[str, str] = {}
    for option, path in files:
        if path.is_dir():
            raise CalibrationError(f"{path} is a folder; name a file with {option}")
        other = known.setdefault(os.path.realpath(path), option)
        if other != option:
            raise CalibrationError(
                f"{other} and {option} are the same file, {path}, and one would be lost; name "
                f"another with {option}"
            )
        see_unread(path, option, read)
        see_free(path, option, force=force)
    for option, path in files:
        see_writable(path, remedy=f"Name another file with {option}")


def _from_episodes(folders: Sequence[Path], vlm: str | None) -> "Labelled":
    from tpvqa.bench.labelled_episodes import label_episodes

    with _counting("episodes", len(folders)) as done:
        return label_episodes(folders, vlm=vlm, done=done)


def _from_pictures(
    vlm: str,
    config: "TrialConfig",
    opened: "PictureSet[Picture]",
    books: "list[QuestionBook] | None",
    *,
    hidden: bool,
) -> tuple[str, "list[LabelledAnswer]"]:
    from tpvqa.assembly.answering import vlm_with_answers
    from tpvqa.bench.labelled_pictures import ask_pictures
    from tpvqa.plugins import Closing

    asked = vlm_with_answers(vlm, config)
    try:
        with _counting("pictures", len(opened.manifest.pictures)) as done:
            return asked.name, ask_pictures(asked, opened, books, hidden=hidden, done=done)
    finally:
        if isinstance(asked, Closing):
            asked.close()


def own_book(
    domain: Path | None, problem: Path | None, questions: Path | None
) -> "list[QuestionBook] | None":
    """The questions of one's own domain; None where none is named."""
    from tpvqa.pddl import load_task
    from tpvqa.questions import QuestionBook
    from tpvqa.tasks import QUESTIONS, beside

    if domain is None or problem is None:
        return None
    questions = questions or beside(QUESTIONS, problem, domain)
    return [QuestionBook.load(questions, load_task(domain, problem))]


def _own(domain: Path | None, problems: list[Path]) -> tuple[Path | None, list[Path]]:
    """Domain and problems, where a logic program may be named once for both."""
    from tpvqa.tasks import domain_and_problem

    if len(problems) > 1:
        return domain, problems
    domain, problem = domain_and_problem(domain, next(iter(problems), None))
    return domain, [] if problem is None else [problem]


def _check_own(
    domain: Path | None,
    problems: Sequence[Path],
    world_file: Path | None,
    *,
    pictures: bool,
    trials: int | None,
) -> None:
    """See that files of one's own are given where they are of use.

    Raises:
        TpvqaError: They are not.
    """
    from tpvqa.errors import TpvqaError

    if domain is None or not problems or not (pictures or trials is not None):
        raise TpvqaError(
            "Give --domain and --problem, or a logic program (.lp) as --domain alone, (and "
            "--questions) beside --pictures FOLDER or --trials N."
        )
    if pictures and (len(problems) > 1 or world_file is not None):
        raise TpvqaError("Beside --pictures give one --problem, and no --world-file.")


def _named(tasks: str | None, *, own: bool) -> list[str]:
    """The shipped tasks that are named; by default those of the household, or one's own alone."""
    from tpvqa.errors import TpvqaError

    if tasks is None:
        return [] if own else _tasks_with_pictures()
    names = [part.strip() for part in tasks.split(",") if part.strip()]
    if not names:
        raise TpvqaError("--tasks names no task; write for example --tasks build_tower")
    return names


def _tasks_with_pictures() -> list[str]:
    """The shipped tasks that can be seen; all of them where none can."""
    from tpvqa.tasks import shipped_tasks

    found = shipped_tasks()
    return [files.name for files in found if files.pictures] or [files.name for files in found]


@contextmanager
def _counting(what: str, total: int) -> Iterator[Callable[[], None]]:
    """A bar on standard error that each call moves on by one."""
    done = 0

    def one() -> None:
        nonlocal done
        done += 1
        bar(done, total)

    with _progress(what) as bar:
        bar(0, total)
        yield one


def _progress(what: str) -> "CountBar":
    from tpvqa.cli.progress import CountBar

    return CountBar(what)
