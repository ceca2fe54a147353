"""A trial as an environment, with Gymnasium itself on the other side."""

from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from tpvqa.config import TrialConfig
from tpvqa.episodes import read_episode
from tpvqa.errors import TpvqaError
from tpvqa.events.events import Answered, Ended, Started
from tpvqa.pddl import Action, Atom, load_task
from tpvqa.pddl.conditions import literals
from tpvqa.tasks import find_task
from tpvqa.worlds.symbolic import SymbolicWorld
from tpvqa_robots.bridges.commanded import Command
from tpvqa_robots.bridges.gym import FAILED, GroundedTask


def tower(vlm: str = "oracle:1", **more: object) -> GroundedTask:
    return GroundedTask(TrialConfig(task="collect_toys", vlm=vlm, world="symbolic"), **more)  # type: ignore[arg-type]


def needed(action: Action) -> set[Atom]:
    return {each.atom for each in literals(action.precondition) if each.positive}


def watching(env: GroundedTask, seed: int) -> tuple[float, dict[str, object]]:
    """Asks about all that an action needs and brings about, as the paper's monitor does."""
    files = find_task("collect_toys")
    task = load_task(files.domain, files.problem)
    number = {question.atom: at for at, question in enumerate(env.questions)}
    place = {fact: at for at, fact in enumerate(env.facts)}
    seen, info = env.reset(seed=seed)
    spent, over, cut = 0.0, False, False
    while not (over or cut):
        name, *arguments = env.skills[seen["skill"]].strip("()").split()
        action = task.action(name, arguments)
        wanted = set(task.apply(frozenset(), action)) if seen["acted"] else needed(action)
        for atom in wanted:
            if atom in number:
                seen, reward, over, cut, info = env.step(np.int64(number[atom]))
                spent += reward
        right = all(seen["belief"][place[atom]] > 0.5 for atom in wanted if atom in place)
        wrong = Command.REPEAT if seen["acted"] else Command.REPLAN
        seen, reward, over, cut, info = env.step(env.command(Command.GO_ON if right else wrong))
        spent += reward
    return spent, info


def test_it_is_an_environment_as_gymnasium_has_them() -> None:
    env = tower("oracle:0.9")
    check_env(env, skip_render_check=True)
    env.close()


def test_who_watches_reaches_the_goal_and_who_does_not_seldom() -> None:
    env, reached = tower(), {"watches": 0, "goes on": 0}
    for seed in range(6):
        spent, info = watching(env, seed)
        reached["watches"] += bool(info["completed"])
        assert (spent > -FAILED) == bool(info["completed"])
        env.reset(seed=seed)
        over = False
        while not over:
            _, _, over, _, info = env.step(env.command(Command.GO_ON))
        reached["goes on"] += bool(info["completed"])
    env.close()
    assert reached["watches"] > reached["goes on"]
    assert reached["watches"] >= 5


def test_an_episode_is_logged_as_any_trial_also_one_that_is_left(tmp_path: Path) -> None:
    env = tower(folder=tmp_path)
    env.reset(seed=4)
    env.step(np.int64(0))
    env.reset()
    env.close()
    with pytest.raises(TpvqaError, match="reset"):
        env.step(np.int64(0))
    events = list(read_episode(tmp_path / "seed4-episode0"))
    assert isinstance(events[0], Started)
    assert events[0].monitor == "commanded"
    assert sum(isinstance(event, Answered) for event in events) == 1
    assert isinstance(events[-1], Ended)
    assert events[-1].because == "cancelled"
    assert (tmp_path / "seed4-episode1").is_dir()


def test_gymnasium_finds_it_by_name_and_the_robot_sees() -> None:
    env = gymnasium.make("tpvqa/CollectToys-v0", world="toys", vlm="oracle:1")
    seen, _ = env.reset(seed=1)
    assert env.observation_space.contains(seen)
    assert len(np.unique(seen["picture"])) > 50
    spent = 0.0
    for command in (0, *(len(env.unwrapped.questions) for _ in range(3))):
        seen, reward, over, cut, _ = env.step(np.int64(command))
        assert env.observation_space.contains(seen)
        assert not over
        assert not cut
        spent += float(reward)
    assert spent < 0
    env.close()


def test_who_stops_the_robot_ends_the_episode_and_the_log_says_why(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pressed = [""]
    monkeypatch.setattr(SymbolicWorld, "halted", lambda self: pressed[0], raising=False)
    env = tower(folder=tmp_path)
    env.reset(seed=1)
    pressed[0] = "emergency stop; the robot stands"
    _, _, over, cut, info = env.step(env.command(Command.GO_ON))
    assert (over, cut, info["because"], info["completed"]) == (True, False, "world refused", False)
    env.close()
    (folder,) = tmp_path.iterdir()
    ended = list(read_episode(folder))[-1]
    assert isinstance(ended, Ended)
    assert ended.message == pressed[0]
