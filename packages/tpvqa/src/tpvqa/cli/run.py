"""`tpvqa run`, `resume`, `show` and `report`."""

import json
import sys
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from tpvqa.cli.person import TerminalPerson
    from tpvqa.cli.terminal import EpisodeView
    from tpvqa.episodes import Ended
    from tpvqa.questions import QuestionBook
    from tpvqa.trial import Trial

_EXIT = "Exit codes: 0 goal reached, 1 not reached, 2 bad input, 130 interrupted."


def register(app: typer.Typer) -> None:
    """Add the commands."""
    app.command(epilog=_EXIT)(run)
    app.command(epilog=_EXIT)(resume)
    app.command()(show)
    app.command()(report)


def run(
    task: Annotated[
        str | None,
        typer.Argument(help="A shipped task (see `tpvqa tasks`), or your own domain file."),
    ] = None,
    problem_file: Annotated[
        Path | None, typer.Argument(metavar="[PROBLEM]", help="Your problem, after a domain file.")
    ] = None,
    *,
    world: Annotated[
        str | None,
        typer.Option(
            help="symbolic (the default for your own domain), pictures:FOLDER, scripted:FILE or "
            "a plug-in; the household's tasks: images (their default) or kitchen."
        ),
    ] = None,
    monitor: Annotated[
        str | None,
        typer.Option(
            help="belief (the default), belief:COST=VALUE (question, look, action, person, "
            "failure), tpvqa (the paper's; the default with --majority), tpvqa:LOOKS, effectvqa, "
            "palmevqa, successvqa, tp or none. With a cost of person you are asked, too."
        ),
    ] = None,
    vlm: Annotated[
        str | None,
        typer.Option(
            help="embedded (the default where there are pictures), openai:MODEL, or a noise "
            "model: oracle[:ACCURACY[:RHO]] (the default where there are none)."
        ),
    ] = None,
    seed: Annotated[int, typer.Option(help="Decides every random number.")] = 0,
    episode: Annotated[int, typer.Option(help="Number of the episode under the seed.")] = 0,
    out: Annotated[Path | None, typer.Option(help="Folder for the episode.")] = None,
    domain: Annotated[Path | None, typer.Option(help="Your own domain.")] = None,
    problem: Annotated[Path | None, typer.Option(help="Your own problem.")] = None,
    questions: Annotated[Path | None, typer.Option(help="Questions for your domain.")] = None,
    world_file: Annotated[
        Path | None, typer.Option(help="What disturbances undo in your domain.")
    ] = None,
    base_url: Annotated[str | None, typer.Option(help="Address of an OpenAI-like server.")] = None,
    majority: Annotated[
        str | None,
        typer.Option(help="tie (at least half deny, the default) or strict (more than half)."),
    ] = None,
    calibration: Annotated[
        Path | None,
        typer.Option(help="belief: what the VLM's answers are worth, see `tpvqa calibrate`."),
    ] = None,
    experience: Annotated[
        Path | None,
        typer.Option(help="belief: file with what was learned in earlier trials; kept up to date."),
    ] = None,
    simulator: Annotated[
        str | None,
        typer.Option(
            help="images world: state (the default), or paper (the paper's to the letter)."
        ),
    ] = None,
    pictures: Annotated[
        Path | None, typer.Option(help="pictures and images world: folder of a set of your own.")
    ] = None,
    failure: Annotated[float, typer.Option(help="P(an action fails).", min=0, max=1)] = 0.25,
    disturbance: Annotated[
        float, typer.Option(help="P(a failure undoes something achieved).", min=0, max=1)
    ] = 0.25,
    spontaneous: Annotated[
        float, typer.Option(help="P(something is undone after a success).", min=0, max=1)
    ] = 0.0,
    max_repeats: Annotated[int, typer.Option(help="Repeats of an action in a row.", min=0)] = 10,
    max_replans: Annotated[int, typer.Option(help="Replans in the trial.", min=0)] = 10,
    max_actions: Annotated[int, typer.Option(help="Actions in the trial.", min=1)] = 60,
    planning_timeout: Annotated[
        float, typer.Option(help="Seconds for one call of the planner.", min=0.001)
    ] = 30.0,
    action_deadline: Annotated[
        float | None, typer.Option(help="Seconds for one action.", min=0)
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print the result as JSON; the trial goes to stderr.")
    ] = False,
) -> None:
    """Run one trial: plan, look, ask, act, and repeat or replan where the pictures say so."""
    from tpvqa.belief import Calibration
    from tpvqa.belief.experience import Experience
    from tpvqa.episodes import EpisodeWriter, Limits
    from tpvqa.errors import TpvqaError
    from tpvqa.loop import Interrupted
    from tpvqa.trial import Trial, TrialConfig

    if task is not None and problem_file is not None:
        if domain or problem:
            raise TpvqaError("Domain and problem were given twice; leave one pair out.")
        domain, problem, task = Path(task), problem_file, None
    if task is not None and (domain or problem):
        raise TpvqaError("Give either a shipped task or --domain and --problem, not both.")
    if monitor is None:
        monitor = "belief" if majority is None else "tpvqa"
    if not monitor.strip() or (vlm is not None and not vlm.strip()):
        raise TpvqaError("--monitor and --vlm must not be empty.")
    options = {
        "majority": majority,
        "simulator": simulator,
        "pictures": None if pictures is None else str(pictures.resolve()),
        "base_url": base_url,
    }
    config = TrialConfig(
        task=task,
        domain=None if domain is None else str(domain.resolve()),
        problem=None if problem is None else str(problem.resolve()),
        questions=None if questions is None else str(questions.resolve()),
        world_file=None if world_file is None else str(world_file.resolve()),
        monitor=monitor,
        vlm=vlm,
        world=world,
        seed=seed,
        episode=episode,
        failure=failure,
        disturbance=disturbance,
        spontaneous=spontaneous,
        limits=Limits(repeats=max_repeats, replans=max_replans, actions=max_actions),
        planning_timeout=planning_timeout,
        action_deadline=action_deadline,
        calibration=None if calibration is None else Calibration.load(calibration),
        experience=None if experience is None else Experience.load(experience),
        experience_file=None if experience is None else str(experience.resolve()),
        options={name: value for name, value in options.items() if value is not None},
    )
    views: list[EpisodeView] = []
    with Trial(config, person=_person(views, as_json=as_json)) as trial:
        if (calibration or experience) and not trial.weighs_answers:
            raise TpvqaError(
                f"The monitor {monitor} weighs no answers: leave out --calibration and "
                "--experience, or take --monitor belief."
            )
        for notice in (*trial.book.notices, *_about_calibration(trial)):
            print(f"note: {notice}", file=sys.stderr)
        trial.check()
        folder = out or _new_folder(trial.task.name, seed, episode)
        writer = EpisodeWriter(folder)
        try:
            with _view(as_json=as_json, book=trial.book) as view:
                views.append(view)
                ended = trial.run(writer, folder=folder, listeners=[view])
        except Interrupted as stop:
            ended = stop.ended
        finally:
            writer.close()
        _keep_experience(trial, ended)
    _finish(ended, folder, as_json=as_json)


def resume(
    episode: Annotated[Path, typer.Argument(help="Folder of an unfinished episode.")],
    *,
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
) -> None:
    """Go on with an episode that was interrupted or killed, to the end it would have had."""
    from tpvqa.episodes.log import episode_folder
    from tpvqa.loop import Interrupted
    from tpvqa.resuming import resume as go_on

    episode = episode_folder(episode)
    views: list[EpisodeView] = []
    with _view(as_json=as_json) as view:
        views.append(view)
        try:
            ended = go_on(
                episode,
                listeners=[view],
                person=_person(views, as_json=as_json),
                then=_keep_experience,
            )
        except Interrupted as stop:
            ended = stop.ended
    _finish(ended, episode, as_json=as_json)


def show(
    episode: Annotated[Path, typer.Argument(help="Folder of an episode.")],
    *,
    as_json: Annotated[bool, typer.Option("--json", help="Print the events as JSON.")] = False,
) -> None:
    """Print an episode again."""
    from rich.console import Console

    from tpvqa.cli.terminal import EpisodeView
    from tpvqa.episodes import EVENT, read_episode

    events = read_episode(episode)
    if as_json:
        print(json.dumps([EVENT.dump_python(event, mode="json") for event in events], indent=1))
        return
    view = EpisodeView(Console(), live=False)
    for event in events:
        view(event)


def report(
    episode: Annotated[Path, typer.Argument(help="Folder of an episode.")],
    *,
    out: Annotated[
        Path | None, typer.Option(help="File to write; by default report.html in the episode.")
    ] = None,
) -> None:
    """Write one self-contained HTML page about an episode."""
    from tpvqa.episodes.report import write_report

    print(write_report(episode, out))


def _new_folder(task: str, seed: int, episode: int) -> Path:
    stem = f"{task}-seed{seed}" + (f"-{episode}" if episode else "")
    folder, number = Path("episodes") / stem, 2
    while folder.exists():
        folder, number = Path("episodes") / f"{stem}-run{number}", number + 1
    return folder


def _view(*, as_json: bool, book: "QuestionBook | None" = None):  # type: ignore[no-untyped-def]
    from rich.console import Console

    from tpvqa.cli.terminal import EpisodeView

    console = Console(stderr=as_json)
    return (
        nullcontext(_silent)
        if as_json and not console.is_terminal
        else EpisodeView(console, book=book)
    )


def _about_calibration(trial: "Trial") -> list[str]:
    """What a user should know of what the VLM's answers are taken to be worth."""
    vlm, calibration, notices = trial.vlm_spec, trial.calibration, []
    if not trial.weighs_answers:
        return []
    known = trial.config.experience
    if known is not None and known.trust and known.with_vlm(vlm, calibration).trust is None:
        notices.append(
            f"how far to trust {known.vlm} was learned with another VLM or calibration, and is "
            "learned anew; how often actions fail is taken over"
        )
    if calibration is None and vlm != "oracle":  # which is always right
        notices += [
            f"there is no calibration of {vlm}: its answers are taken to be right in 0.85. "
            f"Calibrated, it is asked less: `tpvqa calibrate --vlm {vlm} …`"
        ]
    if calibration is not None and calibration.vlm not in ("", vlm):
        notices.append(f"the calibration was learnt of {calibration.vlm}, and this VLM is {vlm}")
    return notices


def _keep_experience(trial: "Trial", ended: "Ended") -> None:
    """Write what was learned where the user keeps it, unless other trials wrote there since."""
    from tpvqa.belief.experience import Experience

    learned, config = trial.experience, trial.config
    if learned is None or config.experience_file is None or ended.because == "cancelled":
        return
    path = Path(config.experience_file)
    before = 0 if config.experience is None else config.experience.trials
    there = Experience.load(path)
    if there is not None and there.trials != before:
        print(
            f"note: {path} was written by other trials since this one began, and is left as it is",
            file=sys.stderr,
        )
        return
    learned.save(path)


def _person(views: "list[EpisodeView]", *, as_json: bool) -> "TerminalPerson | None":
    """Whoever sits at the terminal, if anybody does."""
    from rich.console import Console

    from tpvqa.cli.person import TerminalPerson

    console = Console()
    there = sys.stdin is not None and sys.stdin.isatty() and console.is_terminal
    if as_json or not there:
        return None
    return TerminalPerson(console, lambda: views[0].aside())


def _silent(_event: object) -> None:
    """Show nothing."""


def _finish(ended: "Ended", folder: Path, *, as_json: bool) -> None:
    if as_json:
        from tpvqa.episodes import Started, read_episode

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
                    "actions": ended.actions,
                    "questions": ended.questions,
                    "looks": ended.looks,
                    "repeats": ended.repeats,
                    "replans": ended.replans,
                    "episode": str(folder),
                }
            )
        )
    else:
        print(f"episode: {folder}  (tpvqa show {folder} · tpvqa report {folder})")
    if ended.because == "cancelled":
        raise typer.Exit(130)
    reached = ended.believed_goal if ended.completed is None else ended.completed
    raise typer.Exit(0 if reached else 1)
