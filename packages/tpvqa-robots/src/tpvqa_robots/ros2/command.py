"""`tpvqa skill-server`: offer a simulated robot on ROS 2 topics, and as an action."""

from pathlib import Path
from typing import Annotated

import typer


def register(app: typer.Typer) -> None:
    """Add the command to the application."""
    app.command("skill-server")(skill_server)


def skill_server(
    task: Annotated[str, typer.Argument(help="A shipped task.")] = "collect_toys",
    world: Annotated[str, typer.Option(help="The simulated world, as of `tpvqa run`.")] = "toys",
    seed: Annotated[int, typer.Option(help="Of the world.")] = 1,
    prefix: Annotated[str, typer.Option(help="Of the topics.")] = "/tpvqa",
    stop: Annotated[str, typer.Option(help="Topic of emergency stops.")] = "/tpvqa/stop",
    rate: Annotated[float, typer.Option(min=0.1, max=60, help="Pictures a second.")] = 5.0,
    keep: Annotated[
        Path | None,
        typer.Option(help="File for the world's state after every skill; goes on from it."),
    ] = None,
    managed: Annotated[
        bool, typer.Option("--managed", help="Wait to be configured and activated from outside.")
    ] = False,
    sim_time: Annotated[
        bool, typer.Option("--sim-time", help="Stamps are of the clock on /clock.")
    ] = False,
) -> None:
    """Offer a simulated robot's skills, pictures and joints on ROS 2 topics, until Ctrl-C.

    Where tpvqa_interfaces is built (tpvqa build-interfaces), skills are a ROS 2 action, too.

    Exit codes: 0 ended by Ctrl-C or SIGTERM, 2 bad input.
    """
    import signal

    from tpvqa import load_task
    from tpvqa.pddl import State
    from tpvqa.plugins import Closing
    from tpvqa.tasks import find_task
    from tpvqa.worlds.capabilities import truth_of
    from tpvqa.worlds.making import make_world
    from tpvqa_robots.ros2 import typed
    from tpvqa_robots.ros2.kept import Kept
    from tpvqa_robots.ros2.link import load_rclpy
    from tpvqa_robots.ros2.of_world import WorldRobot
    from tpvqa_robots.ros2.server import ACTION, SkillServer
    from tpvqa_robots.truth import atoms_of

    load_rclpy()
    files = find_task(task)
    loaded = load_task(files.domain, files.problem)
    made, _ = make_world(world, {"task": loaded, "seed": seed, "episode": 0})
    try:
        tells = truth_of(made)
        atoms = atoms_of(loaded, loaded.predicates) if tells is not None else frozenset()

        def true() -> State:
            assert tells is not None
            return frozenset(atom for atom in atoms if tells.holds(atom))

        robot = WorldRobot(made, loaded, None if keep is None else Kept(made, keep))
        server = SkillServer(
            robot,
            loaded,
            tuple(made.views()),
            prefix=prefix,
            stop=stop,
            rate=rate,
            truth=None if tells is None else true,
            managed=managed,
            sim_time=sim_time,
        )
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, lambda *_: server.close())
        action = f" and as {prefix}/{ACTION}" if typed.built() else ""
        typer.echo(f"{world} is offered on {prefix}{action}; Ctrl-C ends it.")
        server.run()
    finally:
        if isinstance(made, Closing):
            made.close()
