"""`tpvqa build-interfaces`: build the messages of ROS 2 that a skill's action needs."""

from typing import Annotated

import typer


def register(app: typer.Typer) -> None:
    """Add the command to the application."""
    app.command("build-interfaces")(build_interfaces)


def build_interfaces(
    whole: Annotated[
        bool, typer.Option("--cpp", help="Build them for C++, too; takes twice as long.")
    ] = False,
) -> None:
    """Build tpvqa_interfaces, and the messages of PlanSys2, into this environment.

    Takes half a minute, or nothing where nothing has changed. Where ROS 2 itself is installed,
    colcon builds them as any package. Exit codes: 0 they are there, 2 they cannot be built.
    """
    from tpvqa_robots.interfaces.building import PACKAGES, build

    for package in PACKAGES:
        print(f"{package}: {build(package, whole=whole)}", flush=True)
