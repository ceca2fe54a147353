"""`tpvqa film`: run a trial on the toys' table, and film it."""

import sys
from pathlib import Path
from typing import Annotated

import typer


def register(app: typer.Typer) -> None:
    """Add the command to the application."""
    app.command()(film)


def film(
    out: Annotated[Path, typer.Option(help="New folder for the episode, film.mp4 and film.gif.")],
    task: Annotated[str, typer.Argument(help="A shipped task about the toys.")] = "collect_toys",
    world: Annotated[str, typer.Option(help="toys, or toys:slip=0.2:far=1; no other.")] = "toys",
    monitor: Annotated[str, typer.Option(help="As of `tpvqa run`.")] = "tpvqa",
    vlm: Annotated[str, typer.Option(help="As of `tpvqa run`.")] = "oracle",
    seed: Annotated[int, typer.Option(help="Of the world and of what is drawn.")] = 1,
    speed: Annotated[float, typer.Option(min=1, help="Times as fast as the robot.")] = 5.0,
    gif: Annotated[bool, typer.Option(help="Write film.gif besides film.mp4.")] = True,
) -> None:
    """Run a trial on the toys' table and film it: the room, what the robot sees, what is asked.

    Exit codes as of `tpvqa run`: 0 goal reached, 1 not reached, 2 bad input.
    """
    from tpvqa import Trial, TrialConfig
    from tpvqa.episodes import EpisodeWriter
    from tpvqa.errors import TpvqaError, pasted
    from tpvqa_robots.film.recorder import RATE, Recorder
    from tpvqa_robots.film.writing import write_gif, write_mp4
    from tpvqa_robots.world import ToysWorld

    config = TrialConfig(task=task, world=world, monitor=monitor, vlm=vlm, seed=seed)
    with Trial(config) as trial:
        if not isinstance(trial.world, ToysWorld):
            raise TpvqaError(f"Only the world 'toys' can be filmed, not {world!r}.")
        trial.check()
        recorder = Recorder(trial.world, speed=speed)
        writer = EpisodeWriter(out)
        try:
            ended = trial.run(writer, folder=out, listeners=[recorder])
        except KeyboardInterrupt:
            print(
                f"{out} holds the episode without a film: `tpvqa resume {pasted(out)}` ends the "
                "trial and films nothing; for a film begin anew in another folder",
                file=sys.stderr,
            )
            raise
        finally:
            writer.close()
    write_mp4(out / "film.mp4", recorder.pictures, rate=RATE)
    if gif:
        write_gif(out / "film.gif", recorder.pictures, rate=RATE)
    seconds = len(recorder.pictures) / RATE
    how = "goal reached" if ended.completed else f"goal not reached: {ended.ending}"
    print(f"{how}: {out / 'film.mp4'}, {seconds:.0f} s")
    raise typer.Exit(0 if ended.completed else 1)
