"""The ways in which a trial can go on from a check."""

from enum import StrEnum


class Decision(StrEnum):
    """What a monitor can decide."""

    GO_ON = "go on"
    REPEAT = "repeat"
    REPLAN = "replan"
    DONE = "done"
    GIVE_UP = "give up"
