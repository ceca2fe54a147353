"""How each monitor is drawn: the same in all figures, told apart without colour too."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from tpvqa.errors import MissingExtraError
from tpvqa.plugins import split

FAMILIES = {
    "tpvqa": ("#d55e00", "o"),
    "effectvqa": ("#009e73", "s"),
    "palmevqa": ("#e69f00", "^"),
    "successvqa": ("#cc79a7", "v"),
    "belief": ("#0072b2", "D"),
    "vote": ("#56b4e9", "p"),
    "lead": ("#7a5230", "h"),
    "survey": ("#882255", "<"),
    "tp": ("#4d4d4d", ""),
    "none": ("#4d4d4d", ""),
    "blind": ("#8a8f98", ""),
}
"""Colour and marker of the monitors that are known, from the palette of Okabe and Ito (2008)."""
OTHERS = (("#332288", ">"), ("#999933", "P"), ("#aa4499", "X"), ("#117733", "*"))
"""Those of monitors that others bring."""
LINES: tuple[Any, ...] = ("-", (0, (5, 2)), (0, (1, 1.5)), (0, (5, 2, 1, 2)))
HATCHES = ("", "////", "....", "xxxx")
UNASKED: tuple[Any, ...] = ((0, (4, 3)), (0, (1, 1.5)))
"""Lines of monitors without a marker: they ask nothing, so they are level."""


@dataclass(frozen=True, slots=True)
class Style:
    """How one monitor is drawn.

    Attributes:
        line: Matplotlib's line style.
        marker: Matplotlib's marker; empty for none.
        filled: Whether the marker is.
        hatch: What its bars are filled with.
    """

    colour: str
    line: Any
    marker: str
    filled: bool
    hatch: str

    @property
    def plotted(self) -> dict[str, Any]:
        """What Matplotlib's `plot` is told."""
        return {
            "color": self.colour,
            "linestyle": self.line,
            "marker": self.marker,
            "markerfacecolor": self.colour if self.filled else "white",
            "markeredgecolor": self.colour,
        }


def styles(monitors: Sequence[str]) -> dict[str, Style]:
    """The style of each monitor: colour by its name, line and marker by its arguments."""
    found = {}
    seen: Counter[str] = Counter()
    others = iter(OTHERS * len(monitors))
    families = dict(FAMILIES)
    for monitor in monitors:
        name, _ = split(monitor)
        if name not in families:
            families[name] = next(others)
        colour, marker = families[name]
        k = seen[name]
        seen[name] += 1
        lines = LINES if marker else UNASKED
        found[monitor] = Style(
            colour, lines[k % len(lines)], marker, not k % 2, HATCHES[k % len(HATCHES)]
        )
    return found


def styled_pyplot() -> Any:
    """pyplot in the style of all figures of a bench.

    Raises:
        MissingExtraError: matplotlib is not installed.
    """
    try:
        import matplotlib
    except ImportError as error:
        raise MissingExtraError("matplotlib", "bench", "The figures of a bench") from error
    matplotlib.use("Agg")
    from matplotlib import pyplot

    pyplot.rcParams.update(
        {
            "font.size": 11,
            "axes.spines.top": False,
            "axes.spines.right": False,
            "svg.hashsalt": "tpvqa",
            "figure.constrained_layout.use": True,
            "axes.titlesize": 12,
            "hatch.linewidth": 0.8,
        }
    )
    return pyplot
