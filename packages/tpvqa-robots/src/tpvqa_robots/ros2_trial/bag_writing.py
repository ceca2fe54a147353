"""Writes a bag: a folder in the format of rosbag2, an MCAP file with its metadata.yaml."""

import os
import tempfile
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from shutil import rmtree
from typing import Any

from tpvqa.errors import MissingExtraError, TpvqaError, WriteError
from tpvqa_robots import DISTRIBUTION
from tpvqa_robots.interfaces.definitions import definition
from tpvqa_robots.ros2_trial.bag import Message

VERSION = 5
"""Of metadata.yaml: Humble writes it, and all later ones read it."""


def write_bag(folder: Path, messages: Iterable[Message]) -> int:
    """Write a bag; the folder is there once it is whole.

    Args:
        folder: A new one.
        messages: In the order of their times.

    Returns:
        How many messages it holds.

    Raises:
        MissingExtraError: The MCAP library is not installed.
        TpvqaError: The folder exists.
        WriteError: It cannot be written.
    """
    try:
        from mcap_ros2.writer import Writer
    except ImportError as error:
        raise MissingExtraError(
            "mcap_ros2", "bag", "A bag of a trial", distribution=DISTRIBUTION
        ) from error
    if folder.exists():
        raise TpvqaError(f"{folder} exists. Name another folder with --out.")
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        half = Path(tempfile.mkdtemp(prefix=f".{folder.name}-", dir=folder.parent))
        try:
            name = f"{folder.name}_0.mcap"
            kinds: dict[str, str] = {}
            counts: Counter[str] = Counter()
            times: list[int] = []
            with (half / name).open("wb") as file, Writer(file) as writer:
                schemas: dict[str, Any] = {}
                for message in messages:
                    kind = message.kind.replace("/", "/msg/")
                    if kind not in schemas:
                        schemas[kind] = writer.register_msgdef(kind, definition(message.kind))
                    kinds[message.topic] = kind
                    writer.write_message(
                        message.topic,
                        schemas[kind],
                        message.values,
                        log_time=message.time,
                        sequence=counts[message.topic],
                    )
                    counts[message.topic] += 1
                    times = [*times[:1], message.time]
            (half / "metadata.yaml").write_text(_metadata(name, kinds, counts, times))
            half.chmod(0o755)
            os.replace(half, folder)
        except BaseException:
            rmtree(half, ignore_errors=True)
            raise
    except OSError as error:
        raise WriteError.of(folder, error, "Name another folder with --out") from error
    return counts.total()


def _metadata(name: str, kinds: dict[str, str], counts: Counter[str], times: list[int]) -> str:
    """metadata.yaml, which says of a bag what is in it."""
    lasted = times[-1] - times[0] if times else 0
    start = times[0] if times else 0
    lines = [
        "rosbag2_bagfile_information:",
        f"  version: {VERSION}",
        "  storage_identifier: mcap",
        "  duration:",
        f"    nanoseconds: {lasted}",
        "  starting_time:",
        f"    nanoseconds_since_epoch: {start}",
        f"  message_count: {counts.total()}",
        "  topics_with_message_count:",
    ]
    for topic, kind in kinds.items():
        lines += [
            "    - topic_metadata:",
            f"        name: {topic}",
            f"        type: {kind}",
            "        serialization_format: cdr",
            '        offered_qos_profiles: ""',
            f"      message_count: {counts[topic]}",
        ]
    lines += [
        '  compression_format: ""',
        '  compression_mode: ""',
        "  relative_file_paths:",
        f'    - "{name}"',
        "  files:",
        f'    - path: "{name}"',
        "      starting_time:",
        f"        nanoseconds_since_epoch: {start}",
        "      duration:",
        f"        nanoseconds: {lasted}",
        f"      message_count: {counts.total()}",
    ]
    return "\n".join(lines) + "\n"
