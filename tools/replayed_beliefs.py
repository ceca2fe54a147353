"""See how true beliefs are: `python tools/replayed_beliefs.py EPISODE…`.

The actions and the answers of recorded episodes go through the filter of a belief monitor that
knows nothing of the VLM; what it then believes, at every decision, of the facts that the log tells
there is compared with the truth. So two versions, or two priors, are compared on the very same
evidence: what each would have done with it, which differs by chance, is left out. So are a person's
answers, what sensors said, what tries in vain make doubtful, and priors. Episodes of symbolic
worlds alone tell the truth that this takes.
"""

import sys
from collections.abc import Iterator
from math import log
from pathlib import Path
from statistics import fmean
from tempfile import TemporaryDirectory

from tpvqa.episodes import read_episode
from tpvqa.events.events import Acted, Acting, Answered, Asked, Decided, Observed, Started
from tpvqa.monitors.belief import MOST_FACTS, BeliefMonitor
from tpvqa.pddl import Action, Atom, Literal, task_from_text
from tpvqa.questions import FactQuestion, QuestionBook
from tpvqa.vlm import Answer
from tpvqa.worlds.protocol import Report
from tpvqa.worlds.world_file import load_world_file

TOLD = Report.DONE, Report.FAILED
LEAST = 1e-3
"""Nothing is taken to be believed with less, nor its contrary."""


def compared(folder: Path) -> Iterator[tuple[float, bool]]:
    """How probable facts are by the filter at the decisions of an episode, and whether they hold.

    Args:
        folder: The episode.
    """
    started, *events = read_episode(folder)
    assert isinstance(started, Started)
    task = task_from_text(started.domain, started.problem)
    with TemporaryDirectory() as place:
        words, world = Path(place) / "questions.yaml", Path(place) / "world.yaml"
        words.write_text(started.questions or "", encoding="utf-8")
        world.write_text(started.rules or "", encoding="utf-8")
        book = QuestionBook.load(words if started.questions else None, task)
        rules = load_world_file(world, task) if started.rules else None
    monitor = BeliefMonitor(task, rules=rules, noise_model=started.noise_model)
    questions = {q.text: q for atom in task.atoms() for q in _worded(book, atom)}
    truth, asked, view = frozenset[str](), Asked(look=0, questions=()), None
    done: Action | None = None
    for event in events:
        match event:
            case Observed():
                truth, view = _truth(event.snapshot), event.view
            case Asked():
                asked = event
            case Answered() if not asked.person:
                for each, said in zip(asked.questions, event.answers, strict=True):
                    if question := questions.get(each.text):
                        answer = Answer(question, said.reply, said.p_yes)
                        monitor.evidence.take(question, answer, asked.look, view)
            case Acting():
                _act(monitor, done)
                done = task.action(event.action.name, list(event.action.arguments))
                monitor.belief.act(done, monitor.chances.rates_of(done))
            case Acted():
                assert done is not None
                failed = event.report is Report.FAILED
                monitor.evidence.acted(done.name, failed=failed if event.report in TOLD else None)
                truth = _truth(event.snapshot)
            case Decided():
                for name in event.belief:
                    yield monitor.belief.probability(Atom.parse(name)), name in truth
            case _:
                pass


def _worded(book: QuestionBook, atom: Atom) -> Iterator[FactQuestion]:
    if book.asked(Literal(atom)):
        question = book.fact(Literal(atom))
        yield from (question, *book.in_other_words(question))


def _act(monitor: BeliefMonitor, before: Action | None) -> None:
    """Learn from the action before, and leave its scene."""
    if before is not None:
        monitor.chances.learn(before)
    monitor.evidence.leave()
    if monitor.belief.model.facts > MOST_FACTS:
        monitor.evidence.renumbered(monitor.belief.renew())


def _truth(snapshot: dict[str, dict[str, list[str]]] | None) -> frozenset[str]:
    if snapshot is None:
        raise SystemExit("This world's episodes do not tell the truth.")
    return frozenset(snapshot["simulation"]["state"])


def main() -> None:
    """Print the mean squared error and the log loss, of each episode and of all."""
    scores: list[tuple[float, float]] = []
    for folder in map(Path, sys.argv[1:]):
        told = [(min(max(p, LEAST), 1 - LEAST), true) for p, true in compared(folder)]
        if told:
            squared = fmean((p - true) ** 2 for p, true in told)
            lost = fmean(-log(p if true else 1 - p) for p, true in told)
            scores.append((squared, lost))
            print(f"{folder.name}: squared error {squared:.4f}, log loss {lost:.4f}")
    if not scores:
        raise SystemExit("Name folders of episodes whose monitor was belief.")
    squared, lost = (fmean(each) for each in zip(*scores, strict=True))
    print(f"{len(scores)} episodes: squared error {squared:.4f}, log loss {lost:.4f}")


if __name__ == "__main__":
    main()
