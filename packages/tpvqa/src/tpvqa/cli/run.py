"""`tpvqa run`, `resume`, `config` and `show`."""

import json
import sys
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tpvqa.cli.no_effect import without_effect
from tpvqa.cli.notices import (
    about_answers,
    about_calibration,
    about_prices,
    about_said,
    about_start,
    about_vlm,
    about_words,
    lost_midway,
)
from tpvqa.cli.options import about_files, trial_config, trial_layers, trial_options
from tpvqa.cli.plan import Problem, Task
from tpvqa.cli.saying import tell
from tpvqa.config.layers import NAMEABLE, Layer, as_yaml, settings
from tpvqa.errors import pasted

if TYPE_CHECKING:
    from tpvqa.assembly import Trial
    from tpvqa.cli.person import TerminalPerson
    from tpvqa.cli.terminal import EpisodeView
    from tpvqa.config import TrialConfig
    from tpvqa.errors import WriteError
    from tpvqa.events import Ended
    from tpvqa.questions import QuestionBook

_EXIT = (
    "Exit codes: 0 goal reached, 1 not reached, 2 bad input, 6 something could not be written "
    "(what was is whole, and can be gone on with), 130 interrupted."
)
Verbose = Annotated[
    bool, typer.Option("--verbose", "-v", help="Give the reasons of decisions in full.")
]
_OPTIMAL = Layer({("planner", "spec"): "fast-downward:optimal"}, {("planner", "spec"): "--optimal"})


def register(app: typer.Typer) -> None:
    """Add the commands."""
    app.command(epilog=_EXIT)(run)
    app.command(epilog=_EXIT)(resume)
    app.command("config")(configuration)
    app.command()(prompt)
    app.command()(show)


Optimal = Annotated[
    bool, typer.Option("--optimal", help="Plans of least cost: --planner fast-downward:optimal.")
]


@trial_options()
def run(
    task: Task = None,
    problem_file: Problem = None,
    *,
    layers: Sequence[Layer],
    optimal: Optimal = False,
    out: Annotated[Path | None, typer.Option(help="Folder for the episode.")] = None,
    as_json: Annotated[
        bool,
        typer.Option(
            "--json", help="Print the result as JSON; on a terminal the trial is shown on stderr."
        ),
    ] = False,
    verbose: Verbose = False,
) -> None:
    """Run one trial: plan, look, ask, act, and repeat or replan where the pictures say so."""
    from tpvqa.assembly import Trial
    from tpvqa.assembly.told import about_risk
    from tpvqa.drivers import Interrupted
    from tpvqa.episodes import EpisodeWriter
    from tpvqa.errors import AnswerError, TpvqaError

    layers = trial_layers([*layers, *_optimal(optimal)], task, problem_file)
    config = trial_config(layers)
    views: list[EpisodeView] = []
    with Trial(config, person=_person(views, as_json=as_json)) as trial:
        known = config.monitor
        if (known.calibration or known.experience) and not trial.weighs_answers:
            raise TpvqaError(
                f"The monitor {known.spec} weighs no answers: leave out --calibration and "
                "--experience, or take --monitor belief."
            )
        is_own = config.task.name is None or config.task.questions is not None
        told = (
            *about_files(layers),
            *(about_words(trial.book) if is_own else ()),
            *about_vlm(trial.config, trial.vlm_spec),
            *about_prices(config),
            *_about_calibration(trial),
            *about_risk(trial),
            *without_effect(trial, {key for layer in layers for key in layer.values}),
            *about_said(trial),
            *about_start(trial.task, trial.priors, trial.monitor),
        )
        for notice in told:
            tell(f"note: {notice}", error=True)
        trial.check()
        folder = out or _new_folder(trial.task.name, config.seed, config.episode)
        _can_be_kept(config, folder)
        writer = EpisodeWriter(folder)
        if writer.begun_anew:
            tell(f"note: {folder} held the torn beginning of an episode; begun anew", error=True)
        try:
            with _view(as_json=as_json, verbose=verbose, book=trial.book) as view:
                views.append(view)
                ended = trial.run(writer, folder=folder, listeners=[view])
        except Interrupted as stop:
            ended = stop.ended
        except AnswerError as lost_vlm:
            raise lost_midway(lost_vlm, folder, config) from lost_vlm
        finally:
            writer.close()
        lost = _keep_experience(trial, ended)
        for notice in about_answers(trial.vlm):
            tell(f"note: {notice}", error=True)
    _finish(ended, folder, lost, as_json=as_json)


@trial_options()
def configuration(
    task: Task = None,
    problem_file: Problem = None,
    *,
    layers: Sequence[Layer],
    optimal: Optimal = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print it as JSON.")] = False,
) -> None:
    """Print the configuration of a trial, every setting with where it comes from.

    The task's files are read, and refused as `tpvqa run` would. What is printed can be
    kept in a file, changed there, and given to `tpvqa run --config FILE`.
    """
    from tpvqa.assembly.named_files import see_files

    layers = trial_layers([*layers, *_optimal(optimal)], task, problem_file)
    config = trial_config(layers)
    see_files(config)
    if as_json:
        print(config.model_dump_json(indent=1, by_alias=True))
    else:
        print(as_yaml(config, layers), end="")


def prompt(
    file: Annotated[
        Path | None, typer.Argument(help="A prompt of your own, to be checked.")
    ] = None,
) -> None:
    """Print what a server is told; keep it in a file, change it, give it by --prompt."""
    from tpvqa.vlm.prompt import load_prompt, shipped_text

    if file is None:
        print(shipped_text(), end="")
        return
    made = load_prompt(file)
    examples = len(made.examples)
    tell(f"{file}: can be used; examples: {examples}, digest: {made.digest}")


def _optimal(wanted: bool) -> list[Layer]:
    return [_OPTIMAL] if wanted else []


@trial_options(*(each.key for each in settings() if each.key not in NAMEABLE), file=False)
def resume(
    episode: Annotated[Path, typer.Argument(help="Folder of an unfinished episode.")],
    *,
    layers: Sequence[Layer],
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
    verbose: Verbose = False,
) -> None:
    """Go on with an episode that was interrupted or killed, to the end it would have had.

    An episode may be a stranger's: addresses, files, folders and options of plug-ins that its log
    names are not used unless they are given here. Where one is missing, the command to use is said.
    """
    from tpvqa.drivers import Interrupted
    from tpvqa.episodes.log import episode_folder
    from tpvqa.resuming import resume as go_on

    episode = episode_folder(episode)
    views: list[EpisodeView] = []
    lost: list[WriteError | None] = []
    with _view(as_json=as_json, verbose=verbose) as view:
        views.append(view)
        try:
            ended = go_on(
                episode,
                named=_named(layers),
                listeners=[view],
                person=_person(views, as_json=as_json),
                then=lambda trial, ended: lost.append(_keep_experience(trial, ended)),
            )
        except Interrupted as stop:
            ended = stop.ended
    _finish(ended, episode, lost[0] if lost else None, as_json=as_json)


def show(
    episode: Annotated[Path, typer.Argument(help="Folder of an episode.")],
    *,
    as_json: Annotated[bool, typer.Option("--json", help="Print the events as JSON.")] = False,
    verbose: Verbose = False,
) -> None:
    """Print an episode again."""
    from tpvqa.cli.consoles import ResultConsole
    from tpvqa.cli.terminal import EpisodeView
    from tpvqa.episodes import read_episode
    from tpvqa.events import EVENT, Ended

    events = read_episode(episode)
    if as_json:
        print(
            json.dumps(
                [EVENT.dump_python(event, mode="json", by_alias=True) for event in events], indent=1
            )
        )
        return
    view = EpisodeView(ResultConsole(), live=False, verbose=verbose)
    for event in events:
        view(event)
    if not isinstance(events[-1], Ended):
        tell(f"unfinished; it can be gone on with: tpvqa resume {pasted(episode)}")


def _new_folder(task: str, seed: int, episode: int) -> Path:
    stem = f"{task}-seed{seed}" + (f"-{episode}" if episode else "")
    folder, number = Path("episodes") / stem, 2
    while folder.exists():
        folder, number = Path("episodes") / f"{stem}-run{number}", number + 1
    return folder


def _view(  # type: ignore[no-untyped-def]
    *, as_json: bool, verbose: bool, book: "QuestionBook | None" = None
):
    from tpvqa.cli.consoles import PatientConsole
    from tpvqa.cli.terminal import EpisodeView

    console = PatientConsole(stderr=as_json)
    return (
        nullcontext(_silent)
        if as_json and not console.is_terminal
        else EpisodeView(console, book=book, verbose=verbose)
    )


def _about_calibration(trial: "Trial") -> list[str]:
    """What a user should know of what the VLM's answers are taken to be worth."""
    vlm, calibration, notices = trial.vlm_spec, trial.calibration, []
    if not trial.weighs_answers:
        return []
    known = trial.known
    if known is not None and known.trust and known.with_vlm(vlm, calibration).trust is None:
        notices.append(
            f"how far to trust {known.vlm} was learned with another VLM or calibration, and is "
            "learned anew; how often actions fail is taken over"
        )
    if known is not None and known.domain not in ("", trial.task.domain_name):
        said = f"the experience was learned in another domain, {known.domain}; to learn anew, name"
        notices.append(f"{said} another file with --experience")
    return [*notices, *about_calibration(vlm, calibration, trial.task)]


def _keep_experience(trial: "Trial", ended: "Ended") -> "WriteError | None":
    """Write what was learned where the user keeps it, unless other trials wrote there since; gives
    why it could not be written."""
    from tpvqa.belief.learning.experience import Experience
    from tpvqa.errors import WriteError

    learned, file = trial.experience, trial.config.monitor.experience
    if learned is None or file is None or ended.because == "cancelled":
        return None
    path = Path(file)
    before = 0 if trial.known is None else trial.known.trials
    there = Experience.load(path)
    if there is not None and there.trials != before:
        tell(
            f"note: {path} was written by other trials since this one began, and is left as it is",
            error=True,
        )
        return None
    try:
        learned.save(path)
    except WriteError as error:
        return error
    return None


def _person(views: "list[EpisodeView]", *, as_json: bool) -> "TerminalPerson | None":
    """Whoever sits at the terminal, if anybody does."""
    from rich.console import Console

    from tpvqa.cli.person import TerminalPerson

    console = Console()
    there = sys.stdin is not None and sys.stdin.isatty() and console.is_terminal
    if as_json or not there:
        return None
    return TerminalPerson(console, lambda: views[0].aside())


def _named(layers: Sequence[Layer]) -> dict[str, Any]:
    """What a command line names, by parts."""
    found: dict[str, Any] = {}
    for layer in layers:
        for (part, *name), value in layer.values.items():
            if name:
                found.setdefault(part, {})[name[0]] = value
            else:
                found[part] = value
    return found


def _can_be_kept(config: "TrialConfig", folder: Path) -> None:
    """See that what is learned can be written, beside the episode, before a robot moves.

    Raises:
        TpvqaError: The file would lie in the episode's place, or in its folder.
        WriteError: It cannot.
    """
    from tpvqa.errors import TpvqaError
    from tpvqa.files import resolved, see_writable

    if config.monitor.experience is None:
        return
    path, place = Path(config.monitor.experience), resolved(folder)
    if place in (resolved(path), *resolved(path).parents):
        raise TpvqaError(
            f"{path} is to lie in the folder of this episode, {folder}, and is for others, too; "
            "name another file with --experience"
        )
    see_writable(path, remedy="Name another file with --experience")


def _silent(_event: object) -> None:
    """Show nothing."""


def _finish(ended: "Ended", folder: Path, lost: "WriteError | None", *, as_json: bool) -> None:
    """Print how it ended, and exit accordingly.

    Raises:
        WriteError: `lost`, what could not be written after the end.
    """
    if as_json:
        from tpvqa.episodes import read_episode
        from tpvqa.events import Started

        started = read_episode(folder)[0]
        assert isinstance(started, Started)
        print(
            json.dumps(
                {
                    "task": started.task,
                    "monitor": started.monitor,
                    "vlm": started.vlm,
                    "noise_model": started.noise_model,
                    "completed": ended.completed,
                    "ended_because": ended.ending,
                    "message": ended.message,
                    "unmet": ended.unmet or (),
                    "actions": ended.actions,
                    "questions": ended.questions,
                    "looks": ended.looks,
                    "repeats": ended.repeats,
                    "replans": ended.replans,
                    "usage": ended.usage and ended.usage.model_dump(),
                    "cost": ended.cost,
                    "episode": str(folder),
                }
            )
        )
    else:
        named = pasted(folder)
        tell(f"episode: {folder}  (tpvqa show {named} · tpvqa report {named})")
        if ended.because == "cancelled":
            tell(f"go on:   tpvqa resume {named}")
    if lost is not None:
        raise lost
    if ended.because == "cancelled":
        raise typer.Exit(130)
    reached = ended.believed_goal if ended.completed is None else ended.completed
    raise typer.Exit(0 if reached else 1)
