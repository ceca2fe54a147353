"""Behaviours for py_trees: look whether facts hold, do an action, run a whole monitored trial.

No tick waits for an answer, a plan or a skill: threads do the work, and the behaviour is RUNNING
meanwhile. Only what is interrupted is waited for until the robot stands still. What broke is
FAILURE, with the reason as `feedback_message`, so that the tree can do something about it.
"""

from tpvqa_robots.bridges.trees.act import Act
from tpvqa_robots.bridges.trees.check import Check
from tpvqa_robots.bridges.trees.ground import Ground

__all__ = ["Act", "Check", "Ground"]
