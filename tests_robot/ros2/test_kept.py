"""A simulated world goes on where its server was killed."""

from pathlib import Path
from threading import Event

import pytest

from tests_robot.conftest import Act
from tpvqa import Task, Trial, TrialConfig
from tpvqa.errors import WorldError
from tpvqa.worlds import Report, World
from tpvqa.worlds.capabilities import truth_of
from tpvqa_robots.ros2.kept import Kept
from tpvqa_robots.ros2.of_world import WorldRobot


def made() -> World:
    world: World = Trial(TrialConfig(task="collect_toys", world="symbolic", vlm="oracle")).world
    return world


def test_a_world_goes_on_from_where_it_was_kept(task: Task, act: Act, tmp_path: Path) -> None:
    file = tmp_path / "world.json"
    first = made()
    find = act("find blue_container table")
    robot = WorldRobot(first, task, Kept(first, file))
    done = robot.perform(find, deadline=9.0, cancelled=Event(), feedback=lambda _: None)
    assert done.report is Report.DONE
    later = made()
    truth = truth_of(later)
    assert truth is not None
    assert not truth.successful(find)
    Kept(later, file)
    assert truth.successful(find)
    file.write_text("{}")
    with pytest.raises(WorldError, match="--keep"):
        Kept(made(), file)
