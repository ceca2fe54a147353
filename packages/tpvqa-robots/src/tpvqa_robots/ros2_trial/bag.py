"""An episode as messages: its pictures, and what was planned, believed, asked and decided."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tpvqa.episodes.log import LOG, episode_folder, read_episode
from tpvqa.events import Event, TrialState
from tpvqa.events.events import Acted, Acting, Answered, Decided, Ended, Observed, PlanMade
from tpvqa.events.records import observation_from
from tpvqa.observation import Frame
from tpvqa_robots.ros2_trial.telling import belief_values, episode_values

INFO, WARN = 20, 30
"""Levels of `rcl_interfaces/Log`."""


@dataclass(frozen=True, slots=True)
class Message:
    """A message of a bag.

    Attributes:
        topic: Its topic.
        kind: E.g. `sensor_msgs/CompressedImage`.
        time: When it was logged, in nanoseconds.
        values: By field.
    """

    topic: str
    kind: str
    time: int
    values: dict[str, Any]


def messages_of(
    episode: Path, *, prefix: str = "/tpvqa", began: float | None = None
) -> Iterator[Message]:
    """The messages of an episode, in the order of its log.

    Args:
        episode: Its folder.
        prefix: Of the topics.
        began: When it began, in seconds since 1970; by default the log's own time of its last
            change, less what the episode took. Pictures of a robot behind ROS 2 keep the stamps
            that they came with.

    Raises:
        EpisodeError: There is no episode, or it is damaged.
        PictureError: A picture of it cannot be read.
    """
    folder = episode_folder(episode)
    events = read_episode(folder)
    if began is None:
        began = (folder / LOG).stat().st_mtime - events[-1].time
    state = TrialState()
    for event in events:
        state = state.after(event)
        at = began + event.time
        time = round(at * 1e9)
        if isinstance(event, Observed):
            seen = observation_from(event, folder)
            stamp = event.detail.get("stamp")
            taken = float(stamp) if isinstance(stamp, int | float) else at
            for view, frame in seen.frames.items():
                yield from _pictures(f"{prefix}/{view}", view, frame, time, taken)
        told = {"stamp": _stamp(at), **episode_values(state, event, folder.name)}
        yield Message(f"{prefix}/episode", "tpvqa_interfaces/Episode", time, told)
        believed = belief_values(state, event, folder.name)
        if believed is not None:
            belief = {"stamp": _stamp(at), **believed}
            yield Message(f"{prefix}/belief", "tpvqa_interfaces/Belief", time, belief)
        for level, said in _said(state, event):
            log = {"stamp": _stamp(at), "level": level, "name": "tpvqa", "msg": said}
            log |= {"file": "", "function": event.kind, "line": max(event.number, 0)}
            yield Message("/rosout", "rcl_interfaces/Log", time, log)


def _stamp(seconds: float) -> dict[str, int]:
    whole = int(seconds)
    return {"sec": whole, "nanosec": min(round((seconds - whole) * 1e9), 999_999_999)}


def _pictures(topic: str, view: str, frame: Frame, time: int, taken: float) -> Iterator[Message]:
    header = {"stamp": _stamp(taken), "frame_id": view}
    picture = {"header": header, "format": frame.media_type.rpartition("/")[2], "data": frame.data}
    yield Message(f"{topic}/image", "sensor_msgs/CompressedImage", time, picture)
    if frame.depth is not None:
        metres = np.ascontiguousarray(frame.depth.metres, np.float32)
        height, width = metres.shape
        depth = {"header": header, "height": height, "width": width, "encoding": "32FC1"}
        depth |= {"is_bigendian": 0, "step": width * 4, "data": metres.tobytes()}
        yield Message(f"{topic}/depth", "sensor_msgs/Image", time, depth)
    if frame.intrinsics is not None:
        of = frame.intrinsics
        roi = {"x_offset": 0, "y_offset": 0, "height": 0, "width": 0, "do_rectify": False}
        info = {
            "header": header,
            "height": of.height,
            "width": of.width,
            "distortion_model": "plumb_bob",
            "d": [0.0] * 5,
            "k": [of.fx, 0.0, of.cx, 0.0, of.fy, of.cy, 0.0, 0.0, 1.0],
            "r": [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
            "p": [of.fx, 0.0, of.cx, 0.0, 0.0, of.fy, of.cy, 0.0, 0.0, 0.0, 1.0, 0.0],
            "binning_x": 0,
            "binning_y": 0,
            "roi": roi,
        }
        yield Message(f"{topic}/camera_info", "sensor_msgs/CameraInfo", time, info)


def _said(state: TrialState, event: Event) -> Sequence[tuple[int, str]]:
    """An event in words, each with its level."""
    match event:
        case PlanMade(considered=False):
            steps = ", ".join(step.said for step in event.plan)
            return [(INFO, f"plan: {steps}") if event.plan else (WARN, event.reason)]
        case Answered():
            return [(INFO, f"{e.question.text} {e.answer.reply.value}") for e in state.latest]
        case Decided():
            return [(INFO, f"{event.when} {event.action}: {event.course}: {event.reason}")]
        case Acting():
            return [(INFO, f"acts: {event.action.said}")]
        case Acted():
            level = INFO if event.report == "done" else WARN
            return [(level, f"{event.report}: {event.message}".rstrip(": "))]
        case Ended():
            return [(INFO if event.completed else WARN, f"{event.ending} {event.message}".strip())]
    return []
