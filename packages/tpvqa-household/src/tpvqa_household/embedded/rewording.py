"""Other words for the questions that the embedded network knows: synonyms and simple rewordings.

A whole question is matched or none of it, so that a "not", an "or" or a number that nobody thought
of leaves it unknown. What comes out is looked up among the known questions like any other.
"""

import re
from collections.abc import Iterator

_NAMES = {
    "telly": "tv",
    "tv set": "tv",
    "television set": "television",
    "icebox": "fridge",
    "loaf of bread": "bread",
    "piece of bread": "bread",
    "countertop": "counter",
    "kitchen counter": "counter",
    "worktop": "counter",
    "kitchen table": "table",
    "kitchen sink": "sink",
    "kitchen floor": "floor",
    "washbasin": "sink",
    "ground": "floor",
}
"""Other names of things."""
_PLURALS = {
    "fridges": "fridge",
    "refrigerators": "refrigerator",
    "apples": "apple",
    "plates": "plate",
    "knives": "knife",
    "tables": "table",
    "sinks": "sink",
    "tvs": "tv",
    "televisions": "television",
}
"""Asked for, one is enough; of "the plates" all would be meant."""
_ANY = re.compile(
    r"(?:are|is) there |(?:are|is) any |(?:can|do) you "
    r"|does (?:this |that )?(?:image|picture|photo) "
)
_ASIDE = (
    r"^(?:please )?(?:(?:can|could) you )?(?:please )?(?:tell|say) (?:me )?(?:whether|if) "
    r"(?P<x>.+?) (?P<verb>is|are) (?P<rest>.+)$",
    r"^(?:do you think )(?:that )?(?P<x>.+?) (?P<verb>is|are) (?P<rest>.+)$",
)
_PICTURE = r"(?:image|picture|photo|photograph|scene|view|frame|camera image)"
_SEEN_IN = rf"(?:in|on) (?:this |that )?{_PICTURE}"
_NOW = re.compile(r"^please | (?:currently|right now)(?= |$)| (?:please|at moment)$")
_OF_THE_PICTURE = re.compile(rf"^{_SEEN_IN} | {_SEEN_IN}$")
_IS, _X, _Y = "(?:is|are)", "(?P<x>.+?)", "(?P<y>.+)"
_HAND = "(?:hand|gripper|grasp|claw|grip)"
_HOLDER = rf"(?:robot|gripper|robot {_HAND}|robot arm)"
_LIES = "(?:lying|sitting|resting|standing|placed|located|situated)"
_DOOR = rf"(?:door of )?{_X}(?: door)?"

_PATTERNS: tuple[tuple[str, str], ...] = (
    (rf"{_IS} there (?:any |some )?{_X}", "is there {x} in image"),
    (rf"{_IS} there (?:any |some )?{_X} (?:here|visible|to be seen)", "is there {x} in image"),
    (
        rf"(?:can|do) you (?:see|spot|notice|recognise|recognize) (?:any |some )?{_X}",
        "can you see {x}",
    ),
    (
        rf"{_IS} (?:any |some )?{_X} (?:visible|in view|in sight|shown|present|there|to be seen)",
        "can you see {x}",
    ),
    (rf"{_IS} {_X} {_SEEN_IN}", "can you see {x}"),
    (
        rf"does (?:this |that )?{_PICTURE} (?:show|contain|depict|include) (?:any |some )?{_X}",
        "does picture show {x}",
    ),
    (
        rf"{_IS} {_X} (?:in|inside|within) (?:(?:robot |its ){_HAND}|gripper|{_HAND} of robot)",
        "is {x} in gripper",
    ),
    (
        rf"is {_HOLDER} (?:now |currently )?(?:holding|gripping|carrying|grasping)(?: on to)? {_X}"
        rf"(?: in its {_HAND})?",
        "is robot holding {x}",
    ),
    (
        rf"does {_HOLDER} (?:hold|grip|carry|have|grasp) {_X} in its {_HAND}",
        "does robot have {x} in its hand",
    ),
    (rf"does {_HOLDER} (?:hold|grip|carry) {_X}", "is robot holding {x}"),
    (rf"has {_HOLDER} got {_X} in its {_HAND}", "does robot have {x} in its hand"),
    (
        rf"{_IS} {_X} (?:being )?(?:held|gripped|carried|grasped)"
        rf"(?: by {_HOLDER}| in (?:robot |its ){_HAND})",
        "is {x} held by robot",
    ),
    (
        rf"{_IS} (?:there )?(?:any |some )?{_X} (?:{_LIES} )?(?:on top of|upon|on) {_Y}",
        "is {x} on {y}",
    ),
    (
        rf"{_IS} (?:there )?(?:any |some )?{_X} (?:{_LIES} )?(?:inside of|inside|within|in) {_Y}",
        "is {x} in {y}",
    ),
    (rf"(?:does|do) {_X} (?:lie|sit|rest|stand) (?:on top of|upon|on) {_Y}", "is {x} on {y}"),
    (
        rf"(?:does|do) {_X} (?:lie|sit|rest|stand) (?:inside of|inside|within|in) {_Y}",
        "is {x} in {y}",
    ),
    (rf"is {_DOOR} (?:wide |standing |left )?(?:open|opened)", "is {x} open"),
    (rf"does {_DOOR} stand (?:wide )?open", "is {x} open"),
    (rf"is {_DOOR} (?:closed|shut)", "is {x} closed"),
    (rf"is {_X} (?:turned |switched |powered )?on", "is {x} turned on"),
    (rf"is {_X} (?:turned |switched |powered )?off", "is {x} turned off"),
    (rf"is screen of {_X} (?:on|lit)", "is {x} turned on"),
    (rf"is {_X} screen (?:on|lit)", "is {x} turned on"),
    (rf"is {_X} screen off", "is {x} turned off"),
    (rf"is {_X} (?:clean|washed|cleaned)", "is {x} clean"),
    (rf"is {_X} (?:dirty|unwashed|soiled)", "is {x} dirty"),
    (rf"does {_X} look clean", "is {x} clean"),
    (rf"does {_X} look dirty", "is {x} dirty"),
    (
        rf"(?:is|has) {_X} (?:been )?(?:cut|sliced|split|divided) (?:in|into) "
        "(?:half|halves|two|two halves|two pieces|2|2 halves)",
        "is {x} cut in half",
    ),
    (rf"is {_X} (?:in one piece|intact|whole|uncut|still whole)", "is {x} whole"),
)


def rewordings(spoken: str) -> Iterator[str]:
    """Other questions that mean the same, as words; the likeliest first.

    Args:
        spoken: A question as `lexicon.words` gives it, joined by blanks.
    """
    plain = _named(spoken)
    for aside in _ASIDE:
        found = re.fullmatch(aside, plain)
        if found is not None:
            plain = f"{found['verb']} {found['x']} {found['rest']}"
    said = [plain, _NOW.sub("", plain)]
    said += [_OF_THE_PICTURE.sub("", each) for each in said]
    for text in dict.fromkeys(said):
        yield text
        for pattern, meant in _PATTERNS:
            found = re.fullmatch(pattern, text)
            if found is not None:
                yield meant.format_map(_filled(found))


def _filled(found: re.Match[str]) -> dict[str, str]:
    return {name: text or "" for name, text in found.groupdict().items()}


def _named(spoken: str) -> str:
    names = _NAMES | (_PLURALS if _ANY.match(spoken) else {})
    for name in sorted(names, key=len, reverse=True):
        spoken = re.sub(rf"\b{name}\b", names[name], spoken)
    return spoken
