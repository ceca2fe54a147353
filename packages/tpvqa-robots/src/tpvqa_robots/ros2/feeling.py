"""Joints and gripper of a robot behind topics, and the facts that they tell."""

import math
from collections.abc import Callable
from typing import Any

from tpvqa.observation import SensedFact
from tpvqa_robots.ros2.link import Link, seen
from tpvqa_robots.ros2.pictures import stamp_of
from tpvqa_robots.ros2.setup import SensedRule


class Joints:
    """The latest joint states.

    Args:
        link: The node.
        topic: `sensor_msgs/JointState`.
        rules: Which facts they tell.
        changed: Told when something came.
    """

    def __init__(
        self,
        link: Link,
        topic: str,
        rules: tuple[SensedRule, ...],
        changed: Callable[[], None],
    ):
        from sensor_msgs.msg import JointState

        self._rules, self._changed = rules, changed
        self._felt: dict[str, tuple[float, float]] = {}
        self.stamp = -math.inf
        link.listen(JointState, topic, self._hear, seen())

    def _hear(self, message: Any) -> None:
        pairs = zip(message.name, message.position, strict=False)
        stamp = stamp_of(message)  # arm and gripper may be told by two drivers
        self._felt |= {str(name): (float(x), stamp) for name, x in pairs if math.isfinite(x)}
        self.stamp = stamp
        self._changed()

    def facts(self, now: float, after: float, age: float) -> tuple[SensedFact, ...]:
        """What they tell; nothing where they are older than the last action or the bound."""
        facts = []
        for rule in self._rules:
            position, stamp = self._felt.get(rule.joint, (0.0, -math.inf))
            if stamp > after and now - stamp <= age:
                holds = (position < rule.bound) == rule.below
                facts.append(SensedFact(rule.atom, rule.sure if holds else 1 - rule.sure))
        return tuple(facts)

    def said(self, now: float) -> str:
        """Where the joints are, and how long ago they were so, for people."""
        if not self._felt:
            return "its joints are not known"
        by_time: dict[float, list[str]] = {}
        for name, (x, stamp) in self._felt.items():
            by_time.setdefault(stamp, []).append(f"{name} {x:.3f}")
        return "; ".join(
            f"joints {max(0.0, now - stamp):.1f} s ago: {', '.join(joints)}"
            for stamp, joints in sorted(by_time.items(), reverse=True)
        )
