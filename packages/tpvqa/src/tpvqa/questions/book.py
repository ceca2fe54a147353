"""The questions of a task: facts and actions put into words."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path

from tpvqa.pddl import Action, Atom, Condition, Disjunction, Literal, State, Task, holds, supporting
from tpvqa.pddl.arithmetic import COMPARISONS
from tpvqa.questions import fallback
from tpvqa.questions.lasting import questions_of_running, words_of_parts
from tpvqa.questions.numbers import NumberWords
from tpvqa.questions.question import ActionQuestion, ActionWay, FactQuestion, FactWay, Way
from tpvqa.questions.template import Template
from tpvqa.questions.wordings import Wording, Wordings, parameters_of, read_wordings

STATIC = "no action changes it"
NEVER_TRUE = "it does not hold at first, and nothing can make it true"
UNSEEN = "that an action runs is not seen; give a question for it where it is"


class QuestionBook:
    """Asks about the facts and actions of one task.

    Words come from the domain's questions file; for whatever it does not give, from the names in
    the PDDL. Each such fallback is one sentence in `notices`.

    Args:
        task: The task.
        wordings: What the questions file says; nothing by default.
        wording: How actions are said in questions about them as a whole.
        within: The facts that can ever hold, and the predicates of which any fact may; None where
            that is not known.

    Attributes:
        notices: What a user should know about the words: fallbacks, questions that cannot be
            told apart.
        fallbacks: Those of them that are about words which no file gives.
    """

    def __init__(
        self,
        task: Task,
        wordings: Wordings | None = None,
        wording: Wording = "usual",
        within: tuple[frozenset[Atom], frozenset[str]] | None = None,
    ) -> None:
        wordings = wordings or Wordings()
        self.task, self.wording, self._within = task, wording, within
        self._narrower: QuestionBook | None = None
        self.notices: list[str] = list(wordings.notices)
        self._wordings = wordings
        self._predicates, self._actions = parameters_of(task)
        self._questions = dict(wordings.predicates)
        self._given = frozenset(wordings.predicates)
        self._say, self._done = dict(wordings.say), dict(wordings.done)
        self.fallbacks: list[str] = []
        self._commands: dict[Action, str] = {}
        self._texts: dict[tuple[Atom, int], tuple[str, tuple[Atom, ...]]] = {}
        self._why_not: dict[tuple[Literal, tuple[str, tuple[str, ...]] | None], str | None] = {}
        self._numbers = NumberWords(wordings.numbers, task)
        self._add_fallbacks()

    @staticmethod
    def load(path: str | Path | None, task: Task) -> "QuestionBook":
        """Read a questions file.

        Args:
            path: The YAML file; None for fallbacks alone.
            task: The task that it is about.

        Raises:
            QuestionsError: The file cannot be read or does not fit the domain; the message
                starts with file and line.
        """
        return QuestionBook(task, None if path is None else read_wordings(Path(path), task))

    def worded(self, wording: Wording) -> "QuestionBook":
        """The book that says actions otherwise in questions about them as a whole."""
        if wording == self.wording:
            return self
        return QuestionBook(self.task, self._wordings, wording, self._within)

    def within(self, can_hold: frozenset[Atom], free: frozenset[str]) -> "QuestionBook":
        """The book that does not ask about facts that can never hold: what a negative precondition
        says of everything there is, though most of it is no such thing.

        Args:
            can_hold: The facts that can ever hold.
            free: The predicates of which any fact may.
        """
        within = can_hold, free
        if self._within == within:
            return self
        if self._narrower is None or self._narrower._within != within:
            self._narrower = QuestionBook(self.task, self._wordings, self.wording, within)
        return self._narrower

    def of_states(self) -> "QuestionBook":
        """The book for whoever answers from a state: no picture shows what holds no more."""
        if not self._wordings.still_shown:
            return self
        rest = replace(self._wordings, still_shown=())
        return QuestionBook(self.task, rest, self.wording, self._within)

    # Facts

    def fact(
        self, literal: Literal, *, way: FactWay = Way.PRECONDITION, wording: int = 0
    ) -> FactQuestion:
        """The question about a fact; a negative literal expects the answer *no*.

        Args:
            literal: The fact, or its negation.
            way: The way of asking.
            wording: Which of the file's wordings, counted from 0.
        """
        text, alike = self._said(literal.atom, wording)
        first = self._said(literal.atom, 0)[0] if wording else ""
        fact = Literal(literal.atom)
        still = any(each.matches(fact, None, {}, self.task) for each in self._wordings.still_shown)
        return FactQuestion(text, way, fact.atom, literal.positive, alike, wording, first, still)

    def in_other_words(self, question: FactQuestion) -> tuple[FactQuestion, ...]:
        """A question in every other wording of it that differs; none where a file gives one."""
        found: dict[str, FactQuestion] = {}
        for wording in range(self.wordings(question.subject)):
            other = self.fact(question.literal, way=question.way, wording=wording)
            found.setdefault(other.text, other)
        return tuple(other for text, other in found.items() if text != question.text)

    def wordings(self, predicate: str) -> int:
        """How many wordings there are of the question about a predicate."""
        return 1 + len(self._wordings.others.get(predicate, ()))

    def _said(self, atom: Atom, wording: int) -> tuple[str, tuple[Atom, ...]]:
        if (atom, wording) not in self._texts and atom.predicate in COMPARISONS:
            template, named = self._numbers.template(atom)
            self._texts[atom, wording] = self._fill(template, dict(named)), ()
        elif (atom, wording) not in self._texts:
            values = dict(zip(self._predicates[atom.predicate], atom.arguments, strict=True))
            others = self._wordings.others.get(atom.predicate, ())
            words = others[wording - 1] if wording else self._questions[atom.predicate]
            self._texts[atom, wording] = self._fill(words, values), self._alike(atom)
        return self._texts[atom, wording]

    def _alike(self, atom: Atom) -> tuple[Atom, ...]:
        """The facts that differ only in objects which the question's words leave out."""
        said = {place.parameter for place in self._questions[atom.predicate].placeholders()}
        kinds = self.task.predicates[atom.predicate]
        choices = [
            (argument,)
            if parameter in said
            else tuple(name for name in self.task.objects if self.task.is_a(name, kind))
            for argument, parameter, kind in zip(
                atom.arguments, self._predicates[atom.predicate], kinds, strict=True
            )
        ]
        alike = (Atom(atom.predicate, arguments) for arguments in product(*choices))
        return tuple(other for other in alike if other != atom)

    def asked(self, literal: Literal, action: Action | None = None) -> bool:
        """Whether a literal is asked about (at an action), as a camera can show it."""
        return self.why_not(literal, action) is None

    def why_not(self, literal: Literal, action: Action | None = None) -> str | None:
        """Why a literal is never asked about; None where it is asked."""
        key = (literal, None if action is None else (action.name, action.arguments))
        if key not in self._why_not:
            self._why_not[key] = self._never_asked_because(literal, action)
        return self._why_not[key]

    def _never_asked_because(self, literal: Literal, action: Action | None) -> str | None:
        if literal.atom.predicate in COMPARISONS:
            return self._numbers.why_not(literal.atom)
        name = None if action is None else action.name
        arguments = {} if action is None else self._values(action)
        for pattern in self._wordings.never_asked:
            if pattern.matches(literal, name, arguments, self.task):
                return pattern.because or "the questions file says so"
        if self._runs(literal.atom.predicate) and literal.atom.predicate not in self._given:
            return UNSEEN
        because = self._never_true(literal.atom) if self.task.changes(literal.atom) else STATIC
        doubted = (p.matches(literal, None, {}, self.task) for p in self._wordings.in_doubt)
        return None if because is None or any(doubted) else because

    def _never_true(self, atom: Atom) -> str | None:
        can_hold, free = self._within or ((), ())
        known = self._within is not None and atom.predicate not in free
        return NEVER_TRUE if known and atom not in can_hold else None

    def preconditions(self, action: Action, state: State) -> tuple[FactQuestion, ...]:
        """The questions about what an action's precondition rests on in the believed state.

        Of a disjunction these are the parts that hold; none of them where one part holds that
        rests on nothing askable, as the precondition then does not hang on the others.
        """
        resting = self._rests_on(action.precondition, self.task.extend(state), action)
        return self._questions_about(resting, Way.PRECONDITION, action)

    def effects(self, action: Action, state: State) -> tuple[FactQuestion, ...]:
        """The questions about all effects of an action, negative ones too.

        Args:
            action: The action.
            state: The believed state before it, which decides about conditional effects.
        """
        before = self.task.extend(state)
        happening = [effect.literal for effect in action.effects if holds(effect.condition, before)]
        added = {literal.atom for literal in happening if literal.positive}
        # What is both deleted and added holds afterwards.
        left = [each for each in happening if each.positive or each.atom not in added]
        if action.changes and self.task.numeric is not None:
            after = self.task.apply(state, action)
            left += self.task.numeric.asked_after(action, state, after)
        return self._questions_about(
            (each for each in left if self.asked(each, action)), Way.EFFECT, action
        )

    def goal(self, state: State) -> tuple[FactQuestion, ...]:
        """The questions about what the goal rests on in the believed state."""
        resting = self._rests_on(self.task.goal, self.task.extend(state), None)
        return self._questions_about(resting, Way.EFFECT, None)

    def unasked(self, action: Action, state: State) -> dict[Literal, str]:
        """The literals of an action that no camera shows, each with the reason."""
        resting = supporting(action.precondition, self.task.extend(state))
        everything = [*resting, *(effect.literal for effect in action.effects)]
        reasons = {literal: self.why_not(literal, action) for literal in everything}
        return {literal: reason for literal, reason in reasons.items() if reason is not None}

    # Whole actions

    def possible(self, action: Action) -> ActionQuestion:
        """ "Is it possible to place the bread on the plate here?" """
        return self._action_question(action, Way.POSSIBLE)

    def successful(self, action: Action) -> ActionQuestion:
        """ "Was place the bread on the plate successful?" """
        return self._action_question(action, Way.SUCCESSFUL)

    def did(self, action: Action) -> ActionQuestion:
        """ "Did the robot successfully place the bread on the plate?" """
        return self._action_question(action, Way.DID)

    def say(self, action: Action) -> str:
        """The action as a command: "place the bread on the plate"."""
        said = self._commands.get(action)
        if said is None:  # a long plan is said whole whenever it changes
            said = self._fill(self._say[action.name], self._values(action))
            self._commands[action] = said
        return said

    def done(self, action: Action) -> str:
        """The action once it is done: "placed the bread on the plate"."""
        return self._fill(self._done[action.name], self._values(action))

    # Objects

    def name(self, obj: str) -> str:
        """What an object is called: "toy eggplant" for toy_eggplant."""
        return self._attribute(obj, "name")

    def _attribute(self, obj: str, attribute: str, *, bare: bool = False) -> str:
        given = next((own for own in self._own_attributes(obj) if attribute in own), None)
        template = (self._wordings.attributes if given is None else given).get(attribute)
        if template is not None:
            said = template.without_articles() if bare and attribute != "name" else template
            return said.render(lambda _: self.name(obj))
        return fallback.words_of(obj) if attribute == "name" else ""

    def _own_attributes(self, obj: str) -> Iterator[dict[str, Template]]:
        """The object's attributes, then those of its type and of each wider one."""
        yield dict(self._wordings.of_objects.get(obj, {}))
        kind: str | None = self.task.objects.get(obj)
        seen: set[str] = set()
        while kind is not None and kind not in seen:
            yield dict(self._wordings.of_types.get(kind, {}))
            seen.add(kind)
            kind = self.task.types.get(kind)

    def _values(self, action: Action) -> dict[str, str]:
        return dict(zip(self._actions[action.name], action.arguments, strict=True))

    def _fill(self, template: Template, values: dict[str, str], *, bare: bool = False) -> str:
        """A sentence about objects; bare, without articles but for those in their names."""
        said = template.without_articles() if bare else template
        return said.render(
            lambda place: self._attribute(values[place.parameter], place.attribute, bare=bare)
        )

    def _action_question(self, action: Action, way: ActionWay) -> ActionQuestion:
        bare = self.wording == "paper"
        said = self._fill(self._say[action.name], self._values(action), bare=bare)
        text = self._wordings.ways[way].render(
            lambda place: said if place.attribute == "name" else ""
        )
        return ActionQuestion(text, way, action)

    def _rests_on(self, condition: Condition, state: State, action: Action | None) -> list[Literal]:
        if isinstance(condition, Literal):
            return [condition] if self.asked(condition, action) else []
        parts: Sequence[Condition] = condition.parts
        if isinstance(condition, Disjunction):
            held = [part for part in parts if holds(part, state)]
            resting = [self._rests_on(part, state, action) for part in held or parts]
            if held and not all(resting):
                return []
        else:
            resting = [self._rests_on(part, state, action) for part in parts]
        return [literal for part in resting for literal in part]

    def _questions_about(
        self, literals: Iterable[Literal], way: FactWay, action: Action | None
    ) -> tuple[FactQuestion, ...]:
        """One question for each wording, none where the same words would expect both answers."""
        questions: dict[str, FactQuestion] = {}
        contradictory: set[str] = set()
        for literal in literals:
            question = self.fact(literal, way=way)
            first = questions.setdefault(question.text, question)
            if first.expected != question.expected:
                contradictory.add(question.text)
                where = "the goal" if action is None else action.name
                self._notice(
                    f"{where}: {first.atom} and {question.atom} are asked in the same words "
                    f"({question.text!r}) and expect opposite answers, so neither is asked."
                )
        return tuple(each for text, each in questions.items() if text not in contradictory)

    def _runs(self, predicate: str) -> bool:
        """Whether a predicate says that an action is running."""
        return self.task.lasting is not None and predicate in self.task.lasting.predicates

    # Fallbacks

    def _may_be_asked(self, predicate: str) -> bool:
        """Whether an action changes facts of a predicate, or the file doubts them."""
        doubted = {pattern.fact.predicate for pattern in self._wordings.in_doubt}
        return predicate in self.task.fluents | self.task.derived | doubted

    def _add_fallbacks(self) -> None:
        never = {
            pattern.fact.predicate for pattern in self._wordings.never_asked if pattern.everywhere
        }
        for name, parameters in self._predicates.items():
            if name in self._questions:
                continue
            text = fallback.question_about(name, parameters)
            self._questions[name] = Template.parse(text)
            if name not in never and not self._runs(name) and self._may_be_asked(name):
                self._fall_back(
                    f"No question is given for the predicate {name}; asked as {text!r}."
                )
        for name in self._numbers.unsaid():
            self._notice(
                f"No question is given for the number {name} (under 'numbers'), so it is not asked."
            )
        lasting = self.task.lasting
        for name, parameters in self._actions.items():
            if lasting is not None and lasting.name_of(name) is not None:
                continue
            said = name in self._say
            if not said:
                self._say[name] = Template.parse(fallback.say(name, parameters))
                self._fall_back(
                    f"The action {name} has no words; said as {str(self._say[name])!r}."
                )
            if name not in self._done:
                self._done[name] = Template.parse(fallback.past(str(self._say[name])))
                if said:
                    self._fall_back(
                        f"The action {name} has no words for when it is done; said as "
                        f"{str(self._done[name])!r}."
                    )
        for name, say, done in words_of_parts(self.task, self._say, self._done):
            self._say.setdefault(name, say)
            self._done.setdefault(name, done)
        for name, question in questions_of_running(self.task, self._say):
            if name not in self._given:
                self._questions[name] = question

    def _fall_back(self, sentence: str) -> None:
        self.fallbacks.append(sentence)
        self._notice(sentence)

    def _notice(self, sentence: str) -> None:
        if sentence not in self.notices:
            self.notices.append(sentence)
