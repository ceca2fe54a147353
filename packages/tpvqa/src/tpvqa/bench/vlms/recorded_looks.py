"""The looks of recorded episodes, with what was asked about them and what was right."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from tpvqa.belief import LabelledAnswer
from tpvqa.bench.labelled_episodes import label_episodes
from tpvqa.bench.vlms.looks import Labelled, LabelledLook, named
from tpvqa.bench.written_actions import WrittenActions
from tpvqa.episodes import read_episode
from tpvqa.episodes.log import episode_folder
from tpvqa.errors import CalibrationError, pasted
from tpvqa.events import Started
from tpvqa.events.events import Asked, Observed, QuestionRecord
from tpvqa.events.records import observation_from
from tpvqa.labelling import check_apart, read_recorded
from tpvqa.labelling.recorded import OF_FACTS
from tpvqa.observation import Observation
from tpvqa.pddl import Atom, Literal, Task, task_from_text
from tpvqa.questions import ActionQuestion, FactQuestion, Question, QuestionBook

AS_ASKED = "as asked"
"""The wording of a question in an episode."""
OF_EPISODES = "the looks of one episode"
"""What makes a group."""


@dataclass
class _Episode:
    folder: Path
    started: Started
    looks: Mapping[int, Observed]
    questions: Mapping[tuple[str, str], QuestionRecord]
    _task: Task | None = None
    _actions: WrittenActions | None = None

    @property
    def task(self) -> Task:
        if self._task is None:
            self._task = task_from_text(self.started.domain, self.started.problem)
        return self._task

    def question(self, record: QuestionRecord) -> Question:
        if record.way in OF_FACTS and record.atom is not None:
            alike = tuple(map(Atom.parse, record.alike or ()))
            atom = Atom.parse(record.atom)
            wording = record.wording or 0
            return FactQuestion(record.text, record.way, atom, record.expected, alike, wording)  # type: ignore[arg-type]
        if self._actions is None:
            self._actions = WrittenActions(self.task)
        assert record.action is not None
        return ActionQuestion(record.text, record.way, self._actions[record.action])  # type: ignore[arg-type]


def looks_of_episodes(
    folders: Iterable[Path | str], wordings: Mapping[str, Path] | None = None
) -> list[LabelledLook]:
    """Every look that was asked about, with the questions whose right answer is known.

    A simulated world's log tells it, or a person's labels do. All looks of an episode hang
    together.

    Args:
        folders: The episodes'.
        wordings: Questions files whose words are taken instead, for facts.

    Raises:
        CalibrationError: Of an episode nobody knows what was right, it has no pictures, or it is a
            copy of another.
        EpisodeError: There is no episode, or it is damaged.
        QuestionsError: A questions file does not fit an episode's domain.
    """
    found: list[LabelledLook] = []
    episodes = dict.fromkeys(map(episode_folder, folders))
    check_apart(map(read_recorded, episodes))
    for folder in episodes:
        told = label_episodes([folder])
        if told.inferred or not told.rows:
            raise CalibrationError(
                f"{folder}: nobody knows what was right in it. Label it "
                f"(`tpvqa label {pasted(folder)}`), or leave it out"
            )
        found += _looks(_read(folder), told.rows, wordings or {})
    if not found:
        raise CalibrationError(
            "These episodes hold no pictures: there is nothing to be asked about"
        )
    return found


def task_of(folder: Path | str) -> Task:
    """The task of an episode, as its log tells it."""
    return _read(episode_folder(folder)).task


def _read(folder: Path) -> _Episode:
    events = read_episode(folder)
    started = events[0]
    assert isinstance(started, Started)
    asked = [each for event in events if isinstance(event, Asked) for each in event.questions]
    return _Episode(
        folder,
        started,
        {event.look: event for event in events if isinstance(event, Observed)},
        {(each.way, each.text): each for each in asked},
    )


def _looks(
    episode: _Episode, rows: Sequence[LabelledAnswer], wordings: Mapping[str, Path]
) -> Iterator[LabelledLook]:
    books = {name: QuestionBook.load(file, episode.task) for name, file in wordings.items()}
    by_look: dict[int, dict[tuple[str, str], LabelledAnswer]] = {}
    for row in rows:
        by_look.setdefault(row.look, {}).setdefault((row.way, row.text), row)
    for look, of_look in sorted(by_look.items()):
        seen = episode.looks.get(look)
        if seen is None or not seen.frames:
            continue
        asked = tuple(
            each
            for key, row in of_look.items()
            for each in _worded(episode.question(episode.questions[key]), row, books)
        )
        if asked:
            read = partial(_observed, seen, episode.folder)
            yield LabelledLook(f"{episode.folder}#{look}", str(episode.folder), read, asked)


def _worded(
    question: Question, row: LabelledAnswer, books: Mapping[str, QuestionBook]
) -> Iterator[Labelled]:
    scene = "/".join((row.trial, row.part, row.scene))
    if not books:
        what = question.atom if isinstance(question, FactQuestion) else question.action
        yield Labelled(question, row.truth, what.pddl(), named(AS_ASKED, question), scene)
    elif isinstance(question, FactQuestion):
        for name, book in books.items():
            literal = Literal(question.atom, question.expected)
            said = book.fact(literal, way=question.way)
            for each in (said, *book.in_other_words(said)):
                yield Labelled(each, row.truth, question.atom.pddl(), named(name, each), scene)


def _observed(seen: Observed, folder: Path, look: int) -> Observation:
    return replace(observation_from(seen, folder), look=look)
