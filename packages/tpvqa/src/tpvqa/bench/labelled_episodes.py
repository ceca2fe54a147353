"""Answers beside the truth, from recorded episodes: a world's, a person's, or what is probable."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import nullcontext, suppress
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory

from tpvqa.assembly.simulating import undoings
from tpvqa.belief import Calibration, LabelledAnswer
from tpvqa.belief.calibrating.fitting import fit
from tpvqa.belief.calibrating.own_words import OwnWords
from tpvqa.bench.labelled import Labeller
from tpvqa.bench.written_actions import WrittenActions
from tpvqa.episodes import read_episode
from tpvqa.episodes.log import episode_folder
from tpvqa.errors import CalibrationError, PDDLError, pasted
from tpvqa.events import Ended, Event, Started
from tpvqa.events.events import Acted, Waited
from tpvqa.labelling import LABELS, RecordedEpisode, check_apart, read_labels, read_recorded
from tpvqa.labelling.inferring import inferred_rows, likelier
from tpvqa.labelling.labels import Said
from tpvqa.labelling.recorded import Stretches, said_in_trial
from tpvqa.labelling.rows import answers_some, labelled_rows, labels_for, stray_labels
from tpvqa.labelling.session import check_vlm
from tpvqa.pddl import Atom, Task, task_from_text
from tpvqa.vlm.making import as_logged, in_full
from tpvqa.worlds import Report
from tpvqa.worlds.simulation import Simulation
from tpvqa.worlds.world_file import WorldRules, load_world_file

_INFERRED = (
    "nobody has labelled these answers: what was right is inferred from what came before and "
    "after, and counts for a quarter. `tpvqa label` on some of these episodes tells it better."
)


@dataclass(frozen=True, slots=True)
class Labelled:
    """The answers of some episodes.

    Attributes:
        vlm: Whose answers they are.
        rows: The answers. One whose truth was inferred stands there twice: as far as yes was
            right, and as far as no.
        own: What the robot itself said.
        by_hand: Labels that a person gave; each holds for all answers of its moment.
        inferred: Answers of which later steps told what was probably right.
        unused: Episodes without truth and without labels, where there are labels elsewhere.
        idle: Files of labels that say of no question what was right.
        stray: What is to be told of labels that are of no question.
    """

    vlm: str
    rows: list[LabelledAnswer]
    own: OwnWords = field(default_factory=OwnWords)
    by_hand: int = 0
    inferred: int = 0
    unused: int = 0
    idle: tuple[Path, ...] = ()
    stray: tuple[str, ...] = ()

    @property
    def plain(self) -> list[LabelledAnswer]:
        """The answers, each once: to be counted and drawn."""
        return likelier(self.rows) if self.inferred else self.rows

    def fit(self) -> Calibration:
        """What the answers are worth, and who said what was right.

        Raises:
            CalibrationError: There is no answer among them.
            MissingExtraError: scikit-learn is needed and not installed.
        """
        found = fit(self.rows, self.vlm).hearing(self.own)
        notices = list(found.notices)
        if self.inferred:
            notices.append(_INFERRED)
        notices += [*self.stray, *map(_says_nothing, self.idle)]
        if self.unused:
            said = "1 episode has" if self.unused == 1 else f"{self.unused} episodes have"
            notices.append(f"{said} neither labels nor the truth, and taught nothing.")
        # A label holds for many answers of a moment, which say little more than the first.
        rows = found.whole.rows if self.by_hand or self.inferred else found.rows
        told = {"rows": rows, "by_hand": self.by_hand, "inferred": self.inferred}
        return found.model_copy(update={**told, "notices": tuple(notices)})


def label_episodes(
    folders: Iterable[Path | str],
    *,
    vlm: str | None = None,
    done: Callable[[], None] = lambda: None,
) -> Labelled:
    """Label the answers of recorded episodes.

    What a person has labelled goes before what a simulated world's log says was true, about the
    question that was labelled and no other. A robot's log says nothing of that; where there are no
    labels at all, what was right is inferred from what came before and after
    (`labelling.inferring`).

    Args:
        folders: The episodes' folders.
        vlm: Whose answers are wanted; by default whoever answered.
        done: Called after each episode.

    Raises:
        CalibrationError: An episode holds the truth of some actions only, another VLM answered in
            it, it is a copy of another, its labels are damaged, or they are all there is and
            answer no question.
        EpisodeError: There is no episode, or it is damaged.
    """
    rows: list[LabelledAnswer] = []
    heard = OwnWords()
    seen: list[RecordedEpisode] = []
    labelled: list[RecordedEpisode] = []
    untold: list[RecordedEpisode] = []
    idle: list[Path] = []
    stray: list[str] = []
    lacking = corrected = 0
    for folder in map(str, dict.fromkeys(map(episode_folder, folders))):
        events = read_episode(folder)
        started = events[0]
        assert isinstance(started, Started)
        answered = as_logged(started.vlm)
        vlm = in_full(vlm) if vlm else answered
        check_vlm(folder, answered, vlm)
        recorded = read_recorded(folder)
        seen.append(recorded)
        file = recorded.folder / LABELS
        answering = answers_some(recorded)
        useless = file.exists() and not answering
        if useless:
            idle.append(file)
        stray += _of_no_question(file, stray_labels(recorded))
        played: _Played | None = None
        if any(map(_tells_truth, events)):
            labels = labels_for(recorded) if answering else {}
            with suppress(CalibrationError) if answering else nullcontext():
                played = _play(events, started, folder, labels)  # it may know of some actions alone
        if played is not None:
            rows += played.rows
            heard.add(played.own)
            corrected += len(played.labelled & read_labels(recorded).keys())
        elif answering or any(map(said_in_trial, recorded.askings)):
            labelled.append(recorded)
        elif useless:
            lacking += 1
        else:
            untold.append(recorded)
        done()
    check_apart(seen)
    of_labels, by_hand = labelled_rows(labelled)
    rows += of_labels
    by_hand += corrected
    if lacking and not (rows or untold):
        raise CalibrationError(f"{_says_nothing(idle[0])} Nothing else tells what was right")
    if rows or not untold:
        unused = len(untold) + lacking
        told = Labelled(vlm or "", rows, heard, by_hand=by_hand, unused=unused)
    else:
        inferred = inferred_rows(untold, vlm or "")
        if not inferred:
            _check_readable(untold)
        told = Labelled(vlm or "", inferred, heard, inferred=len(inferred) // 2)
    return replace(told, idle=tuple(idle), stray=tuple(stray))


def _check_readable(episodes: Sequence[RecordedEpisode]) -> None:
    """See that the domains which logs hold can be read; from others nothing is inferred."""
    for each in episodes:
        try:
            task_from_text(each.started.domain, each.started.problem)
        except PDDLError as error:
            raise CalibrationError(
                f"{each.folder}: the log holds a domain and a problem that cannot be read "
                f"({error}), so that nothing is inferred from it. Label it "
                f"(`tpvqa label {pasted(each.folder)}`), or leave it out"
            ) from error


def _of_no_question(file: Path, labels: Sequence[tuple[int, str]]) -> list[str]:
    if not labels:
        return []
    (stretch, text), *others = labels
    said = f"{len(labels)} labels are" if others else "1 label is"
    return [
        f"{file}: {said} of no question that was asked, and count{'' if others else 's'} for "
        f'nothing: "{text}" (stretch {stretch})'
        + (", …" if others else "")
        + f". Label anew (`tpvqa label {pasted(file.parent)}`), or remove the lines."
    ]


def _says_nothing(file: Path) -> str:
    return (
        f"{file} answers none of the episode's questions with yes or no, so it counts for nothing. "
        f"Label some (`tpvqa label {pasted(file.parent)}`), or remove it."
    )


@dataclass(frozen=True, slots=True)
class _Played:
    """The answers of an episode whose log says what was true.

    Attributes:
        rows: The answers.
        own: What the robot itself said.
        labelled: What labels went before the log's truth of.
    """

    rows: list[LabelledAnswer]
    own: OwnWords
    labelled: frozenset[tuple[int, str]]


def _play(
    events: list[Event], started: Started, name: str, told: Mapping[tuple[int, str], Said]
) -> _Played:
    """Play the truth of an episode back beside its answers, and put labels in its place.

    Where the pictures do not tell, as a label says, an answer teaches nothing.
    """
    task, rules = _stage(started.domain, started.problem, started.rules)
    start = frozenset(map(Atom.parse, started.true_start or started.initial))
    simulation = Simulation(task, rules, undoing=undoings(task, rules), start=start)
    labeller = Labeller(simulation, WrittenActions(task), name)
    stretches, rows = Stretches(), list[LabelledAnswer]()
    counted = set[tuple[int, str]]()
    for event in events:
        stretches.take(event)
        if isinstance(event, Acted | Waited):
            if event.truth is not None:
                gone, new = (
                    frozenset(map(Atom.parse, part))
                    for part in (event.truth.removed, event.truth.added)
                )
                simulation.become((simulation.state - gone) | new)
            elif isinstance(event, Acted) and event.report in (Report.DONE, Report.FAILED):
                raise _untold(name)
        labeller(event)
        for row in labeller.rows:
            key = stretches.number, row.text
            said = told.get(key)
            if said in ("yes", "no"):
                counted.add(key)
                rows.append(replace(row, truth=said == "yes"))
            elif said is None:
                rows.append(row)
        labeller.rows.clear()
    return _Played(rows, labeller.own, frozenset(counted))


def _tells_truth(event: Event) -> bool:
    if isinstance(event, Acted):
        return event.truth is not None
    return isinstance(event, Ended) and event.goal_holds is not None


def _untold(name: str) -> CalibrationError:
    return CalibrationError(
        f"{name}: the log says of some actions what was true, and of others not. Label it "
        f"(`tpvqa label {pasted(name)}`), or leave it out"
    )


@lru_cache(maxsize=16)
def _stage(domain: str, problem: str, rules: str | None) -> tuple[Task, WorldRules]:
    """Task and world file as they were when the episode ran, whatever the files say now."""
    task = task_from_text(domain, problem)
    if rules is None:
        return task, WorldRules()
    with TemporaryDirectory() as folder:
        path = Path(folder) / "world.yaml"
        path.write_text(rules, encoding="utf-8")
        return task, load_world_file(path, task)
