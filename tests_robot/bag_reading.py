"""A bag read back by the MCAP library, message by message, and held against its episode."""

from pathlib import Path
from typing import Any

import numpy as np
import yaml
from mcap_ros2.reader import read_ros2_messages

from tpvqa.episodes import read_episode
from tpvqa.events import EVENT, TrialState
from tpvqa.events.events import Decided, Observed
from tpvqa.events.records import observation_from


def check_bag(episode: Path, bag: Path) -> dict[str, list[Any]]:
    """See that a bag holds its episode, and nothing else; the messages by topic."""
    said = yaml.safe_load((bag / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    (name,) = said["relative_file_paths"]
    found: dict[str, list[Any]] = {}
    times = []
    for message in read_ros2_messages(bag / name):
        found.setdefault(message.channel.topic, []).append(message.ros_msg)
        times.append(message.log_time_ns)
    assert times == sorted(times)
    assert said["starting_time"]["nanoseconds_since_epoch"] == times[0]
    assert said["duration"]["nanoseconds"] == times[-1] - times[0]
    counts = {
        each["topic_metadata"]["name"]: each["message_count"]
        for each in said["topics_with_message_count"]
    }
    assert counts == {topic: len(messages) for topic, messages in found.items()}
    assert said["message_count"] == len(times)

    events, state = read_episode(episode), TrialState()
    beliefs = iter(found["/tpvqa/belief"])
    pictures = {topic: iter(messages) for topic, messages in found.items()}
    began = times[0] / 1e9 - events[0].time
    for event, told in zip(events, found["/tpvqa/episode"], strict=True):
        state = state.after(event)
        assert EVENT.validate_json(told.line) == event
        assert (told.event, told.kind) == (event.number, event.kind)
        assert abs(told.stamp.sec + told.stamp.nanosec / 1e9 - began - event.time) < 1e-3
        assert told.plan == ([] if state.plan is None else [s.pddl() for s in state.plan.plan])
        if isinstance(event, Decided):
            belief = next(beliefs)
            assert belief.event == event.number
            facts = {each.fact: each.probability for each in belief.facts}
            assert facts == (event.belief or {atom.pddl(): 1.0 for atom in state.believed})
        if isinstance(event, Observed):
            for view, frame in observation_from(event, episode).frames.items():
                shown = next(pictures[f"/tpvqa/{view}/image"])
                assert bytes(shown.data) == frame.data
                assert shown.header.frame_id == view
                if "stamp" in event.detail:
                    stamp = shown.header.stamp.sec + shown.header.stamp.nanosec / 1e9
                    assert abs(stamp - event.detail["stamp"]) < 1e-6
                if frame.depth is not None:
                    depth = next(pictures[f"/tpvqa/{view}/depth"])
                    metres = np.frombuffer(bytes(depth.data), np.float32)
                    metres = metres.reshape(depth.height, depth.width)
                    assert np.array_equal(metres, frame.depth.metres, equal_nan=True)
    assert next(beliefs, None) is None
    for topic, left in pictures.items():
        if topic.endswith("/image"):
            assert next(left, None) is None
    said_in_words = [each.msg for each in found["/rosout"]]
    assert any(text.startswith("plan: ") for text in said_in_words)
    return found
