"""`tpvqa ros2-run` and `tpvqa bag`."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from tpvqa.cli.options import trial_config, trial_layers, trial_options
from tpvqa.cli.plan import Problem, Task
from tpvqa.config.layers import Layer


def register(app: typer.Typer) -> None:
    """Add the commands to the application."""
    app.command("ros2-run")(ros2_run)
    app.command()(bag)


@trial_options()
def ros2_run(
    task: Task = None,
    problem_file: Problem = None,
    *,
    layers: Sequence[Layer],
    out: Annotated[Path, typer.Option(help="Folder of the episodes.")] = Path("episodes"),
    prefix: Annotated[str, typer.Option(help="Of action, service and topics.")] = "/tpvqa",
    managed: Annotated[
        bool, typer.Option("--managed", help="Wait to be configured and activated from outside.")
    ] = False,
    sim_time: Annotated[
        bool, typer.Option("--sim-time", help="Stamps are of the clock on /clock.")
    ] = False,
) -> None:
    """Offer the loop as a ROS 2 action, RunTask, until Ctrl-C.

    Takes what `tpvqa run` takes; a goal may name another shipped task, a problem of its domain, and
    a seed. Exit codes: 0 ended by SIGTERM or shut down, 2 bad input, 130 interrupted.
    """
    import signal

    from tpvqa import Trial
    from tpvqa_robots.ros2_trial.server import RunTaskServer

    config = trial_config(trial_layers(layers, task, problem_file))
    with Trial(config):  # what cannot be made is told now, and not by the first goal
        pass
    server = RunTaskServer(
        config,
        out,
        prefix=prefix,
        managed=managed,
        sim_time=sim_time,
        say=lambda text: print(text, flush=True),
    )
    signal.signal(signal.SIGTERM, lambda *_: server.close())
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background ignores it
    print(f"RunTask is offered as {prefix}/run_task; Ctrl-C ends it.", flush=True)
    server.run()


def bag(
    episode: Annotated[Path, typer.Argument(help="Folder of an episode.")],
    *,
    out: Annotated[
        Path | None, typer.Option(help="New folder; by default `bag` in the episode.")
    ] = None,
    prefix: Annotated[str, typer.Option(help="Of the topics.")] = "/tpvqa",
    began: Annotated[
        float | None,
        typer.Option(
            help="When it began, in seconds since 1970; by default as its log's file says."
        ),
    ] = None,
) -> None:
    """Write an episode as a bag of rosbag2 in MCAP: pictures, plan, belief, decisions, and a log.

    ROS 2 need not be installed. Exit codes: 0 written, 2 bad input, 6 it could not be written.
    """
    from tpvqa.cli.saying import tell
    from tpvqa.episodes.log import episode_folder
    from tpvqa_robots.ros2_trial.bag import messages_of
    from tpvqa_robots.ros2_trial.bag_writing import write_bag

    folder = episode_folder(episode) / "bag" if out is None else out
    count = write_bag(folder, messages_of(episode, prefix=prefix, began=began))
    tell(f"{folder}: {count} messages")
