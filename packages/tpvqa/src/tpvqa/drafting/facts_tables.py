"""Words that join things, and other words for the same."""

from tpvqa.drafting.lexicon import word_set

COMPARED = word_set(
    "smaller larger bigger taller heavier lighter higher lower shorter longer "
    "wider thicker hotter colder less more older newer"
)
LINKS = {
    "adjacent": "to",
    "next": "to",
    "close": "to",
    "equal": "to",
    "similar": "to",
    "full": "of",
    "half": "full of",
    "empty": "of",
    "free": "of",
    "ready": "for",
    "available": "for",
    "clear": "of",
    "safe": "for",
}
ROADS = word_set(
    "road path way route link bridge connection door edge passage tunnel track corridor line"
)
SAME = {
    "on": "on top of",
    "in": "inside",
    "inside": "in",
    "near": "close to",
    "under": "underneath",
    "beside": "next to",
    "above": "over",
    "behind": "in back of",
    "between": "in between",
}
ELSE = {
    "closed": "shut",
    "shut": "closed",
    "empty": "without anything in it",
    "clean": "free of dirt",
    "dirty": "unclean",
    "free": "available",
    "available": "free",
    "full": "filled completely",
    "lit": "giving light",
    "on": "switched on",
    "off": "switched off",
    "clear": "free",
}

PICTURES = word_set(
    "picture image photo film map scan sample record recording measurement data copy trace video"
)
"""What is of something and made with something."""
HELD = word_set("holding carrying grasping gripping lifting grabbing bearing wearing using")
"""What is done with a thing in the hand."""
HANDLING = word_set("hold carry grasp grip lift grab bear wear use push pull")
"""What somebody does with a thing, the thing being all that is spoken of."""
PLAIN = word_set(
    "hold carry contain support touch grasp cover block push pull follow need see know serve use "
    "face lift drive occupy"
)
"""Verbs whose base, of two things, is no noun: hold(robot, x)."""
UNNAMED = word_set("nothing something anything everything object objects on up off down still out")
"""What is no name of a thing, behind one of these."""
