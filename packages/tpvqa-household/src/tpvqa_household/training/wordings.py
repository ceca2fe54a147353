"""How each subject is asked about in words: several wordings each, some the other way round."""

from collections.abc import Iterator
from dataclasses import dataclass

from tpvqa_household.training.subjects import Subject

NAMES = {"tv": ("TV", "television"), "fridge": ("fridge", "refrigerator")}
_INSIDE = ("sink", "fridge")

_FACTS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "near": (
        (
            "Is there {a x} in the image?",
            "Is there {a x} in the picture?",
            "Can you see {a x}?",
            "Is {a x} visible?",
            "Does the picture show {a x}?",
        ),
        (),
    ),
    "in_hand": (
        (
            "Is the {x} in a robot's hand?",
            "Is the robot holding the {x}?",
            "Is the {x} in the gripper?",
            "Does the robot have the {x} in its hand?",
            "Is the {x} held by the robot?",
        ),
        (),
    ),
    "on": (
        (
            "Is the {x} {at y}?",
            "Is there {a x} {at y}?",
            "Is the {x} lying {at y}?",
            "Does the {x} lie {at y}?",
        ),
        (),
    ),
    "opened": (
        (
            "Is the {x} open?",
            "Is the {x} opened?",
            "Is the door of the {x} open?",
            "Does the {x} stand open?",
        ),
        ("Is the {x} closed?", "Is the {x} shut?", "Is the door of the {x} closed?"),
    ),
    "turned_on": (
        (
            "Is the {x} turned on?",
            "Is the {x} on?",
            "Is the {x} switched on?",
            "Is the {x} running?",
            "Is there something on the screen of the {x}?",
        ),
        ("Is the {x} turned off?", "Is the {x} off?", "Is the screen of the {x} black?"),
    ),
    "clean": (
        ("Is the {x} clean?", "Is the {x} free of dirt?", "Has the {x} been washed?"),
        ("Is the {x} dirty?", "Is there dirt on the {x}?"),
    ),
    "halved": (
        (
            "Is the {x} cut in half?",
            "Is the {x} halved?",
            "Has the {x} been cut in half?",
            "Is the {x} in two halves?",
            "Is the {x} cut?",
        ),
        ("Is the {x} whole?", "Is the {x} in one piece?", "Is the {x} uncut?"),
    ),
}

# base form, -ing form, participle
_ACTIONS: dict[str, tuple[tuple[str, str, str], ...]] = {
    "find": (
        ("find the {x}", "finding the {x}", "found the {x}"),
        ("locate the {x}", "locating the {x}", "located the {x}"),
    ),
    "pick_up": (
        ("pick up the {x}", "picking up the {x}", "picked up the {x}"),
        ("grasp the {x}", "grasping the {x}", "grasped the {x}"),
        ("pick the {x} up", "picking the {x} up", "picked the {x} up"),
    ),
    "place": (
        ("place the {x} {at y}", "placing the {x} {at y}", "placed the {x} {at y}"),
        ("put the {x} {at y}", "putting the {x} {at y}", "put the {x} {at y}"),
    ),
    "open": (
        ("open the {x}", "opening the {x}", "opened the {x}"),
        (
            "open the door of the {x}",
            "opening the door of the {x}",
            "opened the door of the {x}",
        ),
    ),
    "wash": (
        ("wash the {x}", "washing the {x}", "washed the {x}"),
        ("clean the {x}", "cleaning the {x}", "cleaned the {x}"),
    ),
    "turn_on": (
        ("turn on the {x}", "turning on the {x}", "turned on the {x}"),
        ("switch on the {x}", "switching on the {x}", "switched on the {x}"),
        ("turn the {x} on", "turning the {x} on", "turned the {x} on"),
    ),
    "cut_in_half": (
        ("cut the {x} in half", "cutting the {x} in half", "cut the {x} in half"),
        ("halve the {x}", "halving the {x}", "halved the {x}"),
        (
            "cut the {x} in half with the knife",
            "cutting the {x} in half with the knife",
            "cut the {x} in half with the knife",
        ),
    ),
}

_WAYS = {
    "possible": (
        "Is it possible to {base} here?",
        "Can the robot {base} here?",
        "Could the robot {base} now?",
    ),
    "successful": (
        "Was {base} successful?",
        "Was {ing} successful?",
        "Has {ing} worked?",
        "Was the attempt to {base} successful?",
    ),
    "did": (
        "Did the robot successfully {base}?",
        "Did the robot {base}?",
        "Has the robot successfully {done}?",
    ),
}


@dataclass(frozen=True, slots=True)
class Wording:
    """One way to put a question.

    Attributes:
        text: The question.
        inverted: Whether its *yes* means that the fact does not hold.
    """

    text: str
    inverted: bool = False


def _say(template: str, x: str, y: str, where: str) -> str:
    article = "an" if x[0].lower() in "aeiou" else "a"
    preposition = "in" if where in _INSIDE else "on"
    text = template.replace("{x}", x).replace("{a x}", f"{article} {x}")
    return text.replace("{at y}", f"{preposition} the {y}")


def wordings(subject: Subject) -> Iterator[Wording]:
    """All wordings of a subject, the one that the package itself uses first."""
    if subject.form == "fact":
        straight, turned = _FACTS[subject.name]
        templates = [(text, False) for text in straight] + [(text, True) for text in turned]
    else:
        templates = [
            (way.replace("{base}", base).replace("{ing}", ing).replace("{done}", done), False)
            for base, ing, done in _ACTIONS[subject.name]
            for way in _WAYS[subject.form]
        ]
    thing, where = subject.arguments[0], subject.arguments[-1]
    for template, inverted in templates:
        for x in NAMES.get(thing, (thing,)):
            for y in NAMES.get(where, (where,)):
                wording = Wording(_say(template, x, y, where), inverted)
                yield wording
                if "{at y}" not in template:
                    break
