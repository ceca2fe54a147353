"""Belief over time: for each fact that was ever in doubt, its probability at every decision."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import groupby

from tpvqa.episodes.notable_facts import in_doubt, probability
from tpvqa.episodes.report.story import Chapter, Story
from tpvqa.episodes.report.true_facts import TrueFacts
from tpvqa.events.events import Decided

HEIGHT = 100
"""Of a row in the units of its drawing, in which a decision is one unit wide."""
_TICKS = 12


@dataclass(frozen=True, slots=True)
class Column:
    """One decision: which one, about what, and in which chapter it is told.

    `acted` says whether an action was executed just before it.
    """

    number: int
    decided: Decided
    said: str
    chapter: int
    acted: bool

    @property
    def title(self) -> str:
        """What a reader who points at it is told."""
        of = f"{self.decided.when} “{self.said}”" if self.said else "before the first plan"
        return f"decision {self.number}, {of}: {self.decided.course}"


@dataclass(frozen=True, slots=True)
class Run:
    """Neighbouring decisions that look the same: from the first to behind the last."""

    start: int
    end: int


@dataclass(frozen=True, slots=True)
class Row:
    """One fact over all decisions; None where it was not believed in or its truth is not known."""

    fact: str
    said: str
    values: tuple[float | None, ...]
    truths: tuple[bool | None, ...]

    @property
    def line(self) -> str:
        """The probability as an SVG path of steps."""
        return " ".join(
            f"M{run.start} {_y(values[0])}"
            + "".join(f"V{_y(value)}H{run.start + place + 1}" for place, value in enumerate(values))
            for run, values in self._stretches()
        )

    @property
    def area(self) -> str:
        """What lies under the line, as an SVG path."""
        return " ".join(
            f"M{run.start} {HEIGHT}"
            + "".join(f"V{_y(value)}H{run.start + place + 1}" for place, value in enumerate(values))
            + f"V{HEIGHT}Z"
            for run, values in self._stretches()
        )

    @property
    def true(self) -> list[Run]:
        """Where the fact was true."""
        return _runs([truth is True for truth in self.truths])

    @property
    def known(self) -> list[Run]:
        """Where it is known whether it was."""
        return _runs([truth is not None for truth in self.truths])

    @property
    def wrong(self) -> list[Run]:
        """Where the belief was on the wrong side of a half."""
        return _runs(
            [
                value is not None and truth is not None and (value > 0.5) != truth
                for value, truth in zip(self.values, self.truths, strict=True)
            ]
        )

    @property
    def last(self) -> str:
        """The last probability that was believed."""
        return probability([value for value in self.values if value is not None][-1])

    def title(self, column: Column) -> str:
        """What a reader who points at a decision is told."""
        place = column.number - 1
        value, truth = self.values[place], self.truths[place]
        belief = "not needed here" if value is None else f"P = {value:.3f}"
        fact = "" if truth is None else f"; in truth {'true' if truth else 'not true'}"
        return f"{self.said}: {belief}{fact}\n{column.title}"

    def _stretches(self) -> list[tuple[Run, list[float]]]:
        believed = _runs([value is not None for value in self.values])
        return [
            (run, [value for value in self.values[run.start : run.end] if value is not None])
            for run in believed
        ]


MOST_POINTS = 500_000
"""Facts times decisions of a chart, at most."""
COURSES = ("go on", "skip ahead", "repeat", "go back", "replan", "done", "give up")
"""What can be decided, in the order of the key."""


@dataclass(frozen=True, slots=True)
class BeliefChart:
    """The rows with what they share: the decisions from left to right. `left_out` are facts for
    which there is no room."""

    columns: tuple[Column, ...]
    rows: tuple[Row, ...]
    left_out: int = 0
    height: int = HEIGHT

    @property
    def width(self) -> int:
        """The number of decisions."""
        return len(self.columns)

    @property
    def courses(self) -> list[str]:
        """The kinds of decisions that occur, for the key."""
        found = {column.decided.course for column in self.columns}
        return [course for course in COURSES if course in found]

    @property
    def acts(self) -> list[int]:
        """Behind how many decisions an action was executed."""
        return [column.number - 1 for column in self.columns if column.acted]

    @property
    def ticks(self) -> list[int]:
        """The decisions whose numbers are written."""
        step = next(each for each in (1, 2, 5, 10, 20, 50, 10**6) if self.width / each <= _TICKS)
        return list(range(step, self.width + 1, step))

    @property
    def knows_truth(self) -> bool:
        """Whether there is a truth to show anywhere."""
        return any(row.known for row in self.rows)


def chart(story: Story, say: Callable[[str], str]) -> BeliefChart | None:
    """Lay out the beliefs of an episode.

    Args:
        story: The episode.
        say: Words for a fact.

    Returns:
        None where no belief was ever in doubt, or none was kept.
    """
    acted = [chapter.acted for chapter in story.actions if chapter.acted]
    truth = TrueFacts(story.started, known=any(each.truth for each in acted))
    decisions = sum(
        bool(phase.decided and phase.decided.belief)
        for each in story.actions
        for phase in (each.before, each.after)
    )
    doubtful = _doubtful(story.actions)
    facts = doubtful[: max(1, MOST_POINTS // max(500, decisions))]
    columns: list[Column] = []
    truths: list[list[bool | None]] = []
    for number, chapter in enumerate(story.actions, start=1):
        for name, phase in (("before", chapter.before), ("after", chapter.after)):
            if name == "after" and chapter.acted is not None:
                truth.take(chapter.acted)
            if phase.decided is None or not phase.decided.belief:
                continue
            said = chapter.action.said if chapter.action else phase.decided.action
            done = name == "after" and chapter.acting is not None
            columns.append(Column(len(columns) + 1, phase.decided, said, number, done))
            truths.append([truth.holds(fact) for fact in facts])
    rows = [
        Row(
            fact,
            say(fact),
            tuple(column.decided.belief.get(fact) for column in columns),
            tuple(known[place] for known in truths),
        )
        for place, fact in enumerate(facts)
    ]
    left_out = len(doubtful) - len(facts)
    return BeliefChart(tuple(columns), tuple(rows), left_out) if rows else None


def _doubtful(chapters: Sequence[Chapter]) -> list[str]:
    """The facts that were in doubt or changed side, in the order in which that showed first."""
    sides: dict[str, bool] = {}
    found: dict[str, None] = {}
    for chapter in chapters:
        for phase in (chapter.before, chapter.after):
            for fact, p in phase.decided.belief.items() if phase.decided else ():
                if in_doubt(p) or sides.setdefault(fact, p > 0.5) != (p > 0.5):
                    found.setdefault(fact)
    return list(found)


def _runs(marks: Sequence[bool]) -> list[Run]:
    runs = []
    for mark, group in groupby(enumerate(marks), key=lambda each: each[1]):
        places = [place for place, _ in group]
        if mark:
            runs.append(Run(places[0], places[-1] + 1))
    return runs


def _y(p: float) -> str:
    return f"{HEIGHT * (1 - p):.4g}"
