"""Questions about numbers: "Is the battery of the rover at least 20 percent charged?"."""

from collections.abc import Mapping, Sequence

from tpvqa.pddl import Atom, Task
from tpvqa.pddl.arithmetic import of_several
from tpvqa.questions.template import Placeholder, Template

COMPARISON, NUMBER = "comparison", "number"
"""What stands for the comparison and for the number in a question about numbers."""
_WORDS = {
    ">=": "at least",
    "<=": "at most",
    ">": "more than",
    "<": "less than",
    "=": "exactly",
}


def parameters_of_functions(task: Task) -> Mapping[str, list[str]]:
    """What questions about each number may speak of: its arguments, comparison and number."""
    if task.numeric is None:
        return {}
    return {
        name: [*(variable.lstrip("?") for variable, _ in arguments), COMPARISON, NUMBER]
        for name, arguments in task.numeric.functions.items()
        if name in task.numeric.changed
    }


def lacking(template: Template) -> Sequence[str]:
    """What a question about a number has to speak of, and does not."""
    said = {place.parameter for place in template.placeholders()}
    return [word for word in (COMPARISON, NUMBER) if word not in said]


class NumberWords:
    """The words for comparisons.

    Args:
        questions: The question about each function, as a file gives it.
        task: The task.
    """

    def __init__(self, questions: Mapping[str, Template], task: Task):
        self._questions = questions
        self._parameters = parameters_of_functions(task)

    def unsaid(self) -> list[str]:
        """The numbers that actions change and no question is given for."""
        return [name for name in self._parameters if name not in self._questions]

    def why_not(self, atom: Atom) -> str | None:
        """Why a comparison is never asked about; None where it is asked."""
        if of_several(atom.arguments):
            return "it compares several numbers"
        if atom.arguments[0] not in self._questions:
            return f"the questions file has no words for the number {atom.arguments[0]}"
        return None

    def template(self, atom: Atom) -> tuple[Template, Mapping[str, str]]:
        """The question about a comparison, and what stands for the arguments in it."""
        name, *arguments = atom.arguments[:-1]
        if name not in self._questions:
            return Template((f"Is it true: {atom}?",)), {}
        names = self._parameters[name]
        template = Template(tuple(self._said(part, atom) for part in self._questions[name].parts))
        return template, dict(zip(names, arguments, strict=False))

    @staticmethod
    def _said(part: str | Placeholder, atom: Atom) -> str | Placeholder:
        if isinstance(part, Placeholder) and part.parameter == COMPARISON:
            return _WORDS[atom.predicate]
        if isinstance(part, Placeholder) and part.parameter == NUMBER:
            return atom.arguments[-1]
        return part
