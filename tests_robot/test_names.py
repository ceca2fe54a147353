"""What this distribution brings is named where it is missing."""

import typer

from tpvqa.distributions import ROBOTS, brought
from tpvqa_robots.film.command import register as film
from tpvqa_robots.interfaces.command import register as interfaces
from tpvqa_robots.plansys2.command import register as plansys2
from tpvqa_robots.ros2.command import register as ros2
from tpvqa_robots.ros2_trial.command import register as ros2_trial
from tpvqa_robots.tasks import task_files


def test_all_commands_and_tasks_are_named() -> None:
    app = typer.Typer()
    for register in (film, interfaces, plansys2, ros2, ros2_trial):
        register(app)
    assert {*brought(ROBOTS)["command"]} == {*typer.main.get_group(app).commands}
    tasks = {each.name for each in task_files()} | {"collect_toys"}
    assert {*brought(ROBOTS)["task"]} == tasks
