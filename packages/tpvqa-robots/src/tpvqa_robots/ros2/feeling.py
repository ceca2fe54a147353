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
        self.positions: dict[str, float] = {}
        self.stamp = -math.inf
        link.listen(JointState, topic, self._hear, seen())

    def _hear(self, message: Any) -> None:
        pairs = zip(message.name, message.position, strict=False)
        self.positions = {str(name): float(x) for name, x in pairs if math.isfinite(x)}
        self.stamp = stamp_of(message)
        self._changed()

    def facts(self, now: float, after: float, age: float) -> tuple[SensedFact, ...]:
        """What they tell; nothing where they are older than the last action or the bound."""
        if self.stamp <= after or now - self.stamp > age:
            return ()
        facts = []
        for rule in self._rules:
            position = self.positions.get(rule.joint)
            if position is not None:
                holds = (position < rule.bound) == rule.below
                facts.append(SensedFact(rule.atom, rule.sure if holds else 1 - rule.sure))
        return tuple(facts)

    def said(self, now: float) -> str:
        """Where the joints are, and how long ago they were so, for people."""
        if not self.positions:
            return "its joints are not known"
        joints = ", ".join(f"{name} {x:.3f}" for name, x in self.positions.items())
        return f"joints {max(0.0, now - self.stamp):.1f} s ago: {joints}"
