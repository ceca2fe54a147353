"""The file that says where a robot's topics are, and which server does which PDDL action."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from tpvqa.errors import ConfigError, suggestion_or_list
from tpvqa.pddl import Atom, Task
from tpvqa.worlds.stated import stated_atom
from tpvqa.yaml_places import Place, read_yaml

DEADLINE = 60.0
"""Seconds of a skill where nobody says."""
SECTIONS = (
    "skills",
    "cameras",
    "joints",
    "sensed",
    "told",
    "stop",
    "truth",
    "limits",
    "workspace",
    "sim_time",
)


@dataclass(frozen=True, slots=True)
class Server:
    """A skill server: the name of its action, or the prefix of its topics."""

    name: str
    is_action: bool


@dataclass(frozen=True, slots=True)
class Skill:
    """Who carries out a PDDL action, and seconds that it has."""

    server: Server
    deadline: float


@dataclass(frozen=True, slots=True)
class Camera:
    """The topics of one view.

    Attributes:
        image: `sensor_msgs/CompressedImage`, or `sensor_msgs/Image` where it is `raw`.
        raw: See there.
        depth: `sensor_msgs/Image`, 16UC1 in millimetres or 32FC1 in metres; None for none.
        info: `sensor_msgs/CameraInfo`; None for none.
        frame_id: What pictures say they are of; any where it is empty.
    """

    image: str
    raw: bool = False
    depth: str | None = None
    info: str | None = None
    frame_id: str = ""


@dataclass(frozen=True, slots=True)
class SensedRule:
    """A fact that a joint tells: it holds where the joint is below, or above, a bound."""

    atom: Atom
    joint: str
    bound: float
    below: bool
    sure: float


@dataclass(frozen=True, slots=True)
class Workspace:
    """A box, and where the places are that actions name; metres in the robot's base frame."""

    low: tuple[float, ...]
    high: tuple[float, ...]
    places: Mapping[str, tuple[float, ...]]

    def left_by(self, arguments: tuple[str, ...]) -> str | None:
        """The first place named that lies outside; None where none does."""
        for name in arguments:
            at = self.places.get(name)
            if at is not None and not all(
                low <= x <= high for low, x, high in zip(self.low, at, self.high, strict=True)
            ):
                return name
        return None


@dataclass(frozen=True, slots=True)
class Setup:
    """A robot behind topics.

    Attributes:
        skills: PDDL action → who does it.
        cameras: View → its topics; the first is the default one.
        joints: `sensor_msgs/JointState`; None for none.
        sensed: What joints tell.
        told: Predicates of the facts that skills tell of themselves.
        stop: `std_msgs/Bool`: true is an emergency stop.
        truth: What a simulated robot says is true, for judges and noise models; None on a real one.
        age: Seconds that a picture may be old.
        wait: Seconds that pictures, servers and joints are waited for.
        gone: Seconds after which a server that is not heard is gone.
        grace: Seconds that a server has to answer beyond a skill's deadline.
        workspace: What must not be left; None for no bounds.
        sim_time: Whether stamps are of the clock on /clock, as a simulator publishes it.
    """

    skills: Mapping[str, Skill]
    cameras: Mapping[str, Camera]
    joints: str | None
    sensed: tuple[SensedRule, ...]
    told: tuple[str, ...]
    stop: str
    truth: str | None
    age: float
    wait: float
    gone: float
    grace: float
    workspace: Workspace | None
    sim_time: bool = False


def load_setup(path: Path, task: Task) -> Setup:
    """Read the file of a robot.

    Raises:
        ConfigError: It is missing or broken, or does not fit the task; with file and line.
    """
    root = read_yaml(path, ConfigError)
    parts = {} if root is None else root.sections(*SECTIONS)
    for needed in ("skills", "cameras"):
        if needed not in parts or not parts[needed].entries():
            raise ConfigError(f"expected entries under '{needed}:'", file=path)
    known = {schema.name for schema in task.schemas} if hasattr(task, "schemas") else None
    skills = {name: _skill(place) for name, _, place in parts["skills"].entries()}
    if known is not None:
        for name, key, _ in parts["skills"].entries():
            if name not in known:
                raise key.wrong(f"no action {name!r}" + suggestion_or_list(name, known))
    limits = parts["limits"].sections("age", "wait", "gone", "grace") if "limits" in parts else {}
    told = tuple(place.text() for place in parts["told"].texts()) if "told" in parts else ()
    for name in told:
        if name not in task.predicates:
            raise parts["told"].wrong(
                f"no predicate {name!r}" + suggestion_or_list(name, task.predicates)
            )
    return Setup(
        skills=skills,
        cameras={name: _camera(place) for name, _, place in parts["cameras"].entries()},
        joints=_topic(parts.get("joints")),
        sensed=tuple(_rule(place, task) for place in parts["sensed"].items())
        if "sensed" in parts
        else (),
        told=told,
        stop=_topic(parts.get("stop")) or "/tpvqa/stop",
        truth=_topic(parts.get("truth")),
        age=_number(limits.get("age"), 1.0, least=0.01),
        wait=_number(limits.get("wait"), 10.0, least=0.1),
        gone=_number(limits.get("gone"), 2.0, least=0.5),
        grace=_number(limits.get("grace"), 2.0, least=0.1),
        workspace=_workspace(parts.get("workspace"), task),
        sim_time="sim_time" in parts and parts["sim_time"].truth(),
    )


def _skill(place: Place) -> Skill:
    parts = place.sections("server", "action", "deadline")
    if ("server" in parts) == ("action" in parts):
        raise place.wrong(
            "a skill needs either its server, e.g. {server: /tpvqa, deadline: 60}, or its action, "
            "e.g. {action: /tpvqa/execute_skill, deadline: 60}"
        )
    is_action = "action" in parts
    name = _topic(parts["action" if is_action else "server"])
    assert name is not None
    server = Server(name.rstrip("/"), is_action)
    return Skill(server, _number(parts.get("deadline"), DEADLINE, least=0.1))


def _camera(place: Place) -> Camera:
    parts = place.sections("image", "raw", "depth", "info", "frame_id")
    image = _topic(parts.get("image"))
    if image is None:
        raise place.wrong("a camera needs the topic of its pictures, e.g. {image: /camera/image}")
    return Camera(
        image,
        raw="raw" in parts and parts["raw"].truth(),
        depth=_topic(parts.get("depth")),
        info=_topic(parts.get("info")),
        frame_id=parts["frame_id"].text() if "frame_id" in parts else "",
    )


def _rule(place: Place, task: Task) -> SensedRule:
    parts = place.sections("fact", "joint", "below", "above", "sure")
    if "fact" not in parts or "joint" not in parts or ("below" in parts) == ("above" in parts):
        raise place.wrong("expected fact, joint and either 'below' or 'above'")
    below = "below" in parts
    return SensedRule(
        stated_atom(parts["fact"], task),
        parts["joint"].text(),
        _number(parts["below" if below else "above"], 0.0),
        below,
        parts["sure"].share() if "sure" in parts else 0.98,
    )


def _workspace(place: Place | None, task: Task) -> Workspace | None:
    if place is None:
        return None
    parts = place.sections("low", "high", "places")
    if "low" not in parts or "high" not in parts:
        raise place.wrong("a workspace needs 'low' and 'high', e.g. low: [-0.8, -0.8, 0.0]")
    places = {}
    for name, key, at in parts["places"].entries() if "places" in parts else ():
        if name not in task.objects:
            raise key.wrong(f"no object {name!r}" + suggestion_or_list(name, task.objects))
        places[name] = _point(at)
    return Workspace(_point(parts["low"]), _point(parts["high"]), places)


def _point(place: Place) -> tuple[float, ...]:
    numbers = tuple(_number(item, 0.0) for item in place.items())
    if len(numbers) != 3:
        raise place.wrong("expected three numbers: x, y and z in metres")
    return numbers


def _topic(place: Place | None) -> str | None:
    if place is None:
        return None
    name = place.text()
    if not name.startswith("/") or not name.replace("/", "").replace("_", "").isalnum():
        raise place.wrong(f"expected a topic with its leading slash, found {name!r:.60}")
    return name


def _number(place: Place | None, default: float, *, least: float = -math.inf) -> float:
    if place is None:
        return default
    said = str(place.node.value) if place.is_text() else ""
    try:
        number = float(said[:40])
    except ValueError:
        number = math.nan
    if not math.isfinite(number) or number < least:
        at_least = "" if least == -math.inf else f" of {least:g} or more"
        raise place.wrong(f"expected a number{at_least}")
    return number
