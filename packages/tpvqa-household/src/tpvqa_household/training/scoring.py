"""Score any VLM on pictures whose facts are known, by way of asking, predicate and object.

Needs no torch. `score` takes cases: an observation and what is true and visible in it.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass

from tpvqa.observation import Observation
from tpvqa.pddl import Action, Atom, Conjunction, literals
from tpvqa.questions.question import ActionQuestion, FactQuestion, Question, Way
from tpvqa.vlm import VLM
from tpvqa.vlm.answer import Answer, Reply
from tpvqa.vlm.checking import ask_checked
from tpvqa.vlm.metrics import Metrics, Scored, measure
from tpvqa.vlm.sight import ask_seeing
from tpvqa_household.training.asking import Asking
from tpvqa_household.training.facts import Facts, FactTable
from tpvqa_household.training.labels import Label, Labels
from tpvqa_household.training.subjects import ACTION_WAYS, Subject, subject_of
from tpvqa_household.training.wordings import wordings


@dataclass(frozen=True, slots=True)
class Case:
    """A picture to be asked about.

    Attributes:
        observation: The picture.
        facts: Of every fact whether it is true and whether the picture shows it.
        group: What it is reported under, e.g. "known meshes".
    """

    observation: Observation
    facts: Facts
    group: str = "all"


@dataclass(frozen=True, slots=True)
class Row:
    """One scored answer and what it was about."""

    group: str
    subject: Subject
    wording: int
    scored: Scored


def score(
    vlm: VLM, cases: Iterable[Case], asking: Asking, *, every_wording: bool = False
) -> Iterator[Row]:
    """Ask about everything that can be asked, and set the answers beside the truth.

    Things that are in a picture, but so small or hidden that one may or may not say so, are not
    asked about.

    Args:
        vlm: Who answers.
        cases: The pictures.
        asking: What can be asked.
        every_wording: Whether all wordings are asked, not only the package's own.
    """
    texts = {s: list(wordings(s))[: None if every_wording else 1] for s in asking.subjects}
    for case in cases:
        labels = Labels(FactTable.of([case.facts]), asking.actions).of(asking.subjects)[0]
        asked = [
            (subject, number, wording, label)
            for subject, label in zip(asking.subjects, labels.tolist(), strict=True)
            if label != Label.UNCLEAR
            for number, wording in enumerate(texts[subject])
        ]
        questions = [_question(wording.text, subject) for subject, _, wording, _ in asked]
        answers = ask_seeing(vlm, case.observation, questions)
        for (subject, number, wording, label), answer in zip(asked, answers, strict=True):
            truth = (label == Label.YES) != wording.inverted
            shown, hard = label != Label.CANNOT_SEE, label == Label.HARD_NO
            scored = Scored(answer.reply, truth, answer.p_yes, shown, hard)
            yield Row(case.group, subject, number, scored)


def _question(text: str, subject: Subject) -> Question:
    """A question about a subject; of an action only what the words say of it."""
    name, arguments = subject.name, subject.arguments
    if subject.form == "fact":
        return FactQuestion(text, Way.EFFECT, Atom(name, arguments))
    (way,) = (way for way in ACTION_WAYS if way == subject.form)
    return ActionQuestion(text, way, Action(name, arguments, Conjunction(), ()))


def by_way(asking: Asking) -> dict[str, Callable[[Row], bool]]:
    """The ways of asking; facts that are both precondition and effect count in both."""
    needed = {subject_of(x.atom) for a in asking.actions for x in literals(a.precondition)}
    made = {subject_of(e.literal.atom) for a in asking.actions for e in a.effects}
    return {
        "preconditions": lambda row: row.subject in needed,
        "effects": lambda row: row.subject in made,
        **{way.value: _in_form(way) for way in (Way.POSSIBLE, Way.SUCCESSFUL, Way.DID)},
    }


def _in_form(way: Way) -> Callable[[Row], bool]:
    return lambda row: row.subject.form == way


def tables(rows: Sequence[Row], asking: Asking) -> Iterator[tuple[str, dict[str, Metrics]]]:
    """Figures by way of asking, by predicate and by object, each with its heading."""
    facts = [row for row in rows if row.subject.form == "fact"]
    yield (
        "way of asking",
        {
            name: measure(row.scored for row in rows if belongs(row))
            for name, belongs in by_way(asking).items()
        },
    )
    yield "predicate", _split(facts, lambda row: row.subject.name)
    yield "object", _split(facts, lambda row: row.subject.arguments[0])
    yield (
        "action",
        _split([r for r in rows if r.subject.form != "fact"], lambda row: row.subject.name),
    )


def _split(rows: Sequence[Row], key: Callable[[Row], str]) -> dict[str, Metrics]:
    groups: dict[str, list[Scored]] = {}
    for row in rows:
        groups.setdefault(key(row), []).append(row.scored)
    return {name: measure(groups[name]) for name in sorted(groups)}


_COLUMNS = (
    ("n", "visible"),
    ("accuracy", "accuracy"),
    ("balanced", "balanced_accuracy"),
    ("FPR", "false_positive_rate"),
    ("FNR", "false_negative_rate"),
    ("AUROC", "auroc"),
    ("ECE", "calibration_error"),
    ("hard no", "hard_no"),
    ("abstained", "abstained"),
    ("hidden", "hidden"),
    ("cannot see", "cannot_see_rightly"),
)


def as_markdown(heading: str, table: Mapping[str, Metrics]) -> str:
    """A table of figures. Rates are over visible facts, "cannot see" over hidden ones."""
    lines = [
        f"| {heading} | " + " | ".join(name for name, _ in _COLUMNS) + " |",
        "|---" * (len(_COLUMNS) + 1) + "|",
    ]
    for name, metrics in table.items():
        cells = [_cell(getattr(metrics, field)) for _, field in _COLUMNS]
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def _cell(value: float | int | None) -> str:
    if value is None:
        return "–"
    return str(value) if isinstance(value, int) else f"{value:.3f}"


def no_household_answers(vlm: VLM, observations: Iterable[Observation], asking: Asking) -> str:
    """On pictures that show nothing of the household: how often which answer comes.

    Right are *no* for "Is there …?" and *cannot see* or *no* for all else.
    """
    lines = ["| question | yes | no | cannot see | unknown |", "|---|---|---|---|---|"]
    counts: dict[str, list[Answer]] = {}
    for observation in observations:
        texts = {s: next(iter(wordings(s))).text for s in asking.subjects}
        asked = [_question(text, subject) for subject, text in texts.items()]
        answers = ask_checked(vlm, observation, asked)
        for subject, answer in zip(texts, answers, strict=True):
            name = subject.name if subject.form == "fact" else subject.form
            counts.setdefault(name, []).append(answer)
    for name, answers in counts.items():
        shares = [
            sum(answer.reply is reply for answer in answers) / len(answers)
            for reply in (Reply.YES, Reply.NO, Reply.CANNOT_SEE, Reply.UNKNOWN)
        ]
        lines.append(f"| {name} | " + " | ".join(f"{share:.3f}" for share in shares) + " |")
    return "\n".join(lines)


def report(rows: Sequence[Row], asking: Asking) -> str:
    """All tables, by group of pictures."""
    parts = []
    for group in dict.fromkeys(row.group for row in rows):
        inside = [row for row in rows if row.group == group]
        parts.append(f"## {group}")
        parts += [as_markdown(heading, table) for heading, table in tables(inside, asking)]
    return "\n\n".join(parts)


def as_json(rows: Sequence[Row], asking: Asking) -> dict[str, object]:
    """The same figures as plain JSON values."""
    return {
        group: {
            heading: {name: asdict(metrics) for name, metrics in table.items()}
            for heading, table in tables([r for r in rows if r.group == group], asking)
        }
        for group in dict.fromkeys(row.group for row in rows)
    }
