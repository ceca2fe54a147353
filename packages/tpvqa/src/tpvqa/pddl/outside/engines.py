"""The engines that unified-planning knows of: the package of each, and what they plan with."""

from collections.abc import Mapping
from importlib.util import find_spec

PACKAGES: Mapping[str, str] = {
    "aries": "up-aries",
    "enhsp": "up-enhsp",
    "enhsp-any": "up-enhsp",
    "enhsp-opt": "up-enhsp",
    "fast-downward": "up-fast-downward",
    "fast-downward-opt": "up-fast-downward",
    "fmap": "up-fmap",
    "lpg": "up-lpg",
    "lpg-anytime": "up-lpg",
    "pyperplan": "up-pyperplan",
    "pyperplan-opt": "up-pyperplan",
    "symk": "up-symk",
    "symk-opt": "up-symk",
    "tamer": "up-tamer",
}
"""The packages from which the engines come; each has a licence of its own."""

KNOWS: Mapping[str, tuple[str, ...]] = {
    "numbers": ("enhsp", "tamer", "aries"),
    "time": ("tamer", "aries"),
    "processes": ("enhsp",),
    "objects": ("tamer", "aries"),
    "hierarchy": ("aries",),
}
"""What Fast Downward does not know, by what the engines declare in unified-planning 1.3."""


def is_there(engine: str) -> bool:
    """Whether the package that brings an engine is installed."""
    return find_spec(PACKAGES[engine].replace("-", "_")) is not None


def _named(engine: str) -> str:
    where = "installed" if is_there(engine) else f"pip install {PACKAGES[engine]}"
    return f"{engine} ({where})"


def taken(feature: str) -> str:
    """Which planners know a feature, as advice without its full stop."""
    return f"take {', or '.join(f'up:{_named(name)}' for name in KNOWS[feature])}"


def where_known(feature: str) -> str:
    """Who could plan with a feature, as a sentence without its full stop."""
    names = KNOWS.get(feature, ())
    if not names:
        return "None of unified-planning's engines is known to"
    said = map(_named, names)
    if feature == "hierarchy":
        return (
            f"Of unified-planning's engines {', '.join(said)} plans it; tpvqa's loop reads no task "
            "networks"
        )
    return f"Of unified-planning's engines {', '.join(said)} would plan it; tpvqa cannot yet"
