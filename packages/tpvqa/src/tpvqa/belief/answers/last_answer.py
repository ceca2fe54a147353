"""The last answer to a question, and what was heard of it before."""

from collections.abc import Hashable
from dataclasses import dataclass, field

from tpvqa.belief.answers.heard import Heard
from tpvqa.belief.answers.lasting import Columns
from tpvqa.pddl import Atom
from tpvqa.vlm import Reply

Picture = Hashable
"""What tells one picture from another: what it shows, or else the number of the look."""


@dataclass(slots=True)
class LastAnswer:
    """The last answer to a question.

    Attributes:
        pictures: Of which pictures it was asked since something was done last.
        view: From which view the last one was.
        atoms: Yes is right where any of them holds.
        acted: How many actions were done when that was worked out.
        heard: What was heard of it, by view.
    """

    reply: Reply
    pictures: set[Picture]
    view: str | None
    atoms: tuple[Atom, ...]
    acted: int
    heard: dict[str | None, Heard] = field(default_factory=dict)

    def heard_from(self, view: str | None, columns: Columns) -> Heard:
        """What was heard of it, as it counts from a view.

        Args:
            view: The view.
            columns: Of which of all that is told apart of the noise that is known.
        """
        known = self.heard.get(view)
        if known is None:
            known = self.heard[view] = self.heard[self.view].elsewhere(columns)
        return known
