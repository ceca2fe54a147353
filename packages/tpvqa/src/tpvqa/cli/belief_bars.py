"""What is believed after a decision, in the terminal: a small bar for each fact that matters."""

from collections.abc import Callable, Mapping

from tpvqa.cli.saying import marked
from tpvqa.episodes.notable_facts import FactNow, notable, probability
from tpvqa.spelling import plain

_CELLS = 8
_EIGHTHS = " ▏▎▍▌▋▊▉█"
_VISIBLE = 0.02
_WIDEST = 44


class BeliefBars:
    """Lines about a belief that say what is new since they were last printed.

    Args:
        bars: Whether to draw bars; otherwise all facts go into one line, as numbers.
    """

    def __init__(self, *, bars: bool):
        self._bars = bars
        self._told: dict[str, float] = {}

    def lines(self, belief: Mapping[str, float], say: Callable[[str], str]) -> list[str]:
        """Lines of markup about the facts that are in doubt or have changed; often none.

        Args:
            belief: Probabilities of facts.
            say: Words for a fact.
        """
        new = [
            each
            for each in notable(belief, self._told)
            if each.before is None or abs(each.change) >= _VISIBLE
        ]
        for each in new:
            self._told[each.fact] = each.p
        for fact, p in belief.items():
            self._told.setdefault(fact, p)
        if not new:
            return []
        if not self._bars:
            facts = ", ".join(f"{say(each.fact)} {_numbers(each)}" for each in new)
            return [f"  [dim]belief:[/] {marked(facts)}"]
        names = [plain(say(each.fact)) for each in new]
        width = min(_WIDEST, max(map(len, names)))
        return [
            f"    {marked(_fitted(name, width))} {_bar(each.p)} {_coloured(each)}"
            for name, each in zip(names, new, strict=True)
        ]


def bar(p: float, cells: int = _CELLS) -> str:
    """A probability as a bar of block characters, exact to an eighth of a cell.

    >>> bar(0.5, 4), bar(0.85, 4)
    ('██  ', '███▍')
    """
    eighths = round(p * cells * 8)
    full, rest = divmod(eighths, 8)
    return ("█" * full + (_EIGHTHS[rest] if rest else "")).ljust(cells)


def _bar(p: float) -> str:
    return f"[dim]▕[/][cyan]{bar(p)}[/][dim]▏[/]"


def _fitted(name: str, width: int) -> str:
    return name.ljust(width) if len(name) <= width else name[: width - 1] + "…"


def _numbers(fact: FactNow) -> str:
    return probability(fact.p) + (f" ({fact.arrow})" if fact.arrow else "")


def _coloured(fact: FactNow) -> str:
    style = "green" if fact.change > 0 else "red"
    arrow = f" [{style}]{fact.arrow}[/]" if fact.arrow else ""
    return f"[bold]{probability(fact.p):>4}[/]{arrow}"
