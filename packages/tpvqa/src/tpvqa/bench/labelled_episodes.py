"""Answers beside the truth, from recorded episodes in a simulated world."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory

from tpvqa.belief import LabelledAnswer
from tpvqa.bench.labelled import Labeller
from tpvqa.bench.written_actions import WrittenActions
from tpvqa.episodes import read_episode
from tpvqa.errors import CalibrationError
from tpvqa.events import Ended, Event, Started
from tpvqa.events.events import Acted
from tpvqa.pddl import Atom, Task, task_from_text
from tpvqa.worlds import Report
from tpvqa.worlds.simulation import Simulation
from tpvqa.worlds.world_file import WorldRules, load_world_file


@dataclass(frozen=True, slots=True)
class Labelled:
    """The answers of some episodes.

    Attributes:
        vlm: Whose answers they are.
        rows: The answers.
    """

    vlm: str
    rows: list[LabelledAnswer]


def label_episodes(
    folders: Iterable[Path | str],
    *,
    vlm: str | None = None,
    done: Callable[[], None] = lambda: None,
) -> Labelled:
    """Label the answers of recorded episodes, by what the log says truly came of every action.

    Args:
        folders: The episodes' folders.
        vlm: Whose answers are wanted; by default whoever answered.
        done: Called after each episode.

    Raises:
        CalibrationError: An episode does not hold the truth, or another VLM answered in it.
        EpisodeError: There is no episode, or it is damaged.
    """
    rows: list[LabelledAnswer] = []
    for folder in folders:
        events = read_episode(folder)
        started = events[0]
        assert isinstance(started, Started)
        vlm = vlm or started.vlm
        if started.vlm != vlm:
            raise CalibrationError(
                f"{folder}: {started.vlm} answered in it, not {vlm}. A calibration is of one VLM: "
                "give the episodes of each apart"
            )
        rows += _label(events, started, str(folder))
        done()
    return Labelled(vlm or "", rows)


def _label(events: list[Event], started: Started, name: str) -> list[LabelledAnswer]:
    """Play the truth of an episode back beside its answers."""
    if not any(map(_tells_truth, events)):
        raise _untold(name)
    task, rules = _stage(started.domain, started.problem, started.rules)
    simulation = Simulation(task, rules)
    simulation.state = frozenset(map(Atom.parse, started.initial))
    labeller = Labeller(simulation, WrittenActions(task), name)
    for event in events:
        labeller(event)
        if not isinstance(event, Acted):
            continue
        if event.truth is not None:
            gone, new = (
                frozenset(map(Atom.parse, part))
                for part in (event.truth.removed, event.truth.added)
            )
            simulation.state = (simulation.state - gone) | new
        elif event.report in (Report.DONE, Report.FAILED):
            raise _untold(name)
    return labeller.rows


def _tells_truth(event: Event) -> bool:
    if isinstance(event, Acted):
        return event.truth is not None
    return isinstance(event, Ended) and event.goal_holds is not None


def _untold(name: str) -> CalibrationError:
    return CalibrationError(
        f"{name}: the log does not say what was true, as in a simulated world it would. Calibrate "
        "from episodes in a simulated world, from trials (--trials) or from labelled pictures "
        "(--pictures)"
    )


@lru_cache(maxsize=16)
def _stage(domain: str, problem: str, rules: str | None) -> tuple[Task, WorldRules]:
    """Task and world file as they were when the episode ran, whatever the files say now."""
    task = task_from_text(domain, problem)
    if rules is None:
        return task, WorldRules()
    with TemporaryDirectory() as folder:
        path = Path(folder) / "world.yaml"
        path.write_text(rules, encoding="utf-8")
        return task, load_world_file(path, task)
