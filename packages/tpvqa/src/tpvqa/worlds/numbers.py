"""Numbers in a simulated world: what changes them besides actions, and which the robot measures."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from random import Random

from tpvqa.errors import shown, suggestion_or_list
from tpvqa.observation import SensedFact
from tpvqa.pddl import Atom, State, Task
from tpvqa.pddl.arithmetic import (
    ARITHMETIC,
    Expression,
    Words,
    bound,
    evaluated,
    functions_in,
    is_number,
    number,
    parsed,
    text_of,
    values_in,
    written,
)
from tpvqa.pddl.numeric import CHANGES, Numeric, changed, numbers_of, with_values
from tpvqa.yaml_places import Place


@dataclass(frozen=True, slots=True)
class Drift:
    """A change of a number that no action makes.

    Attributes:
        by: By how much.
        chance: How probable it is after an action.
        least: The value below which it does not bring it.
        most: The value above which it does not bring it.
        say: How it is said.
    """

    by: Fraction
    chance: float
    least: Fraction | None = None
    most: Fraction | None = None
    say: str = ""

    def after(self, value: Fraction) -> Fraction:
        """A value after it."""
        new = value + self.by
        if self.least is not None and self.by < 0:
            new = max(new, min(self.least, value))
        if self.most is not None and self.by > 0:
            new = min(new, max(self.most, value))
        return new


@dataclass(frozen=True, slots=True)
class NumberChange:
    """What becomes of a number where something is undone: `(decrease (load) (weight ?s))`.

    Attributes:
        kind: How it changes.
        function: The function with its arguments.
        by: By how much, or to what.
    """

    kind: str
    function: Words
    by: Expression

    @staticmethod
    def parse(place: Place, variables: Collection[str], task: Task) -> "NumberChange":
        """Read it.

        Args:
            place: Where it stands.
            variables: What is bound there.
            task: The task.

        Raises:
            WorldFileError: It is none, or speaks of what is not known.
        """
        text = place.text().lower()
        numbers = task.numeric
        try:
            found = parsed(text)
            kind, function, by = found if isinstance(found, tuple) else ("", "", "")
        except ValueError:
            kind, function, by = "", "", ""
        if kind not in CHANGES or isinstance(function, str) or numbers is None:
            raise place.wrong(f"{text!r} changes no number; write (decrease (load) (weight ?s))")
        for words in (function, *functions_in(by)):
            arguments = numbers.functions.get(str(words[0]))
            if arguments is None or len(arguments) != len(words) - 1:
                raise place.wrong(f"{text!r}: there is no such number as {text_of(words)}")
            for word in words[1:]:
                if word not in variables and word not in task.objects:
                    raise place.wrong(f"{text!r}: nothing says what {word} stands for")
            if not set(words[1:]) & {*variables} and not _has_value(words, numbers):
                raise place.wrong(f"{text!r}: {text_of(words)} has no value in this task")
        why = _no_expression(by)
        if why:
            raise place.wrong(f"{text!r}: {why}")
        if function[0] not in numbers.changed:
            raise place.wrong(f"{text!r}: no action changes {function[0]}, so nothing else does")
        return NumberChange(str(kind), tuple(map(str, function)), by)

    def apply(self, state: State, binding: Mapping[str, str], task: Task) -> State:
        """The state after it; as it was where that cannot be worked out."""
        assert task.numeric is not None
        values = values_in(state)
        function = tuple(binding.get(word, word) for word in self.function)
        by = evaluated(bound(self.by, binding), {**task.numeric.static, **values})
        new = None if by is None else changed(self.kind, values.get(function), by)
        return state if new is None else with_values(state, {function: new})


def _has_value(words: Sequence[object], numbers: Numeric) -> bool:
    return tuple(map(str, words)) in numbers.values


def _no_expression(part: Expression) -> str:
    """Why something stands for no number; nothing where it does."""
    if isinstance(part, str):
        if is_number(part):
            return ""
        return f"expected a number such as 2 or (weight ?s), found {shown(part)}"
    if part[0] not in ARITHMETIC:
        return ""  # a function
    if len(part) != 3:
        return f"{text_of(part)} wants two numbers"
    if part[0] == "/" and isinstance(part[2], str) and not number(part[2]):
        return f"{text_of(part)} divides by 0"
    return _no_expression(part[1]) or _no_expression(part[2])


@dataclass(frozen=True, slots=True)
class NumberRule:
    """What a world file says of a number.

    Attributes:
        function: The function.
        sensed: Whether the robot measures it after every action.
        drift: What changes it besides actions.
    """

    function: str
    sensed: bool = False
    drift: Drift | None = None


def number_rule(entry: Place, task: Task) -> NumberRule:
    """Read an entry.

    Raises:
        WorldFileError: It is none, or of no number that actions change.
    """
    parts = entry.sections("of", "sensed", "drift")
    known = sorted(task.numeric.changed) if task.numeric is not None else []
    if "of" not in parts:
        raise entry.wrong("an entry needs 'of', the name of a number, e.g. of: battery")
    name = parts["of"].text().lower().strip("() ")
    if name not in known:
        raise parts["of"].wrong(
            f"actions change no number {name!r}{suggestion_or_list(name, known)}"
        )
    sensed = parts["sensed"].truth() if "sensed" in parts else False
    return NumberRule(name, sensed, _drift(parts["drift"], name) if "drift" in parts else None)


def _drift(place: Place, name: str) -> Drift:
    parts = place.sections("by", "chance", "least", "most", "say")
    if "by" not in parts or "chance" not in parts:
        raise place.wrong("a drift needs 'by' and 'chance', e.g. by: -10 and chance: 0.2")
    limits = {key: _number(parts[key]) for key in ("by", "least", "most") if key in parts}
    say = parts["say"].text() if "say" in parts else f"{name} changes by itself"
    return Drift(
        limits["by"], parts["chance"].share(), limits.get("least"), limits.get("most"), say
    )


def _number(place: Place) -> Fraction:
    said = str(getattr(place.node, "value", ""))
    if not is_number(said):
        raise place.wrong(f"expected a number such as -10 or 2.5, found {shown(said)}")
    return number(said)


def drifted(
    rules: Sequence[NumberRule], state: State, draw: Random
) -> tuple[Atom, str, State] | None:
    """What changes by itself after an action: the value that was, in words, the state after it.

    Args:
        rules: What the world file says.
        state: The true state.
        draw: Random numbers.
    """
    found: tuple[Atom, str] | None = None
    for rule in rules:
        drift = rule.drift
        if drift is None:
            continue
        for atom in sorted(numbers_of(state)):
            if atom.arguments[0] != rule.function or draw.random() >= drift.chance:
                continue
            words, old = atom.arguments[:-1], number(atom.arguments[-1])
            new = drift.after(old)
            if new != old:
                state = with_values(state, {words: new})
                found = found or (atom, f"{drift.say} ({written(old)} → {written(new)})")
    return None if found is None else (*found, state)


def readings(rules: Sequence[NumberRule], state: State) -> tuple[SensedFact, ...]:
    """What the robot measures of its numbers."""
    names = {rule.function for rule in rules if rule.sensed}
    return tuple(
        SensedFact(atom, 1.0) for atom in sorted(numbers_of(state)) if atom.arguments[0] in names
    )
