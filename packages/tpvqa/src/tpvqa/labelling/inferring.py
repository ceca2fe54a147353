"""What was probably right, where nobody has said it: by what came before and after.

Every fact that was asked about is a chain of true and false through an episode. It begins as the
problem says, actions change it where they do not fail, answers speak for or against it, and that an
action worked speaks for what it needs. Forwards and backwards through the chain (Baum et al. 1970)
each answer is weighed by all others; what answers are worth is learnt from that, and so on in turn
(Dempster, Laird and Rubin 1977: expectation maximisation).

Every answer stands in the likelihood once, and so does what made the robot stop asking: a choice
among answers would make them look better, or worse, than they are.

What it assumes: facts hang together by actions alone; actions fail, and facts change by themselves,
as often as below; the problem's initial state is right; the VLM errs afresh at every look, but for
ρ as by default. A VLM that is wrong in the same way again and again is believed, so what is learnt
counts for little (`WEIGHT`).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tpvqa.belief import Apart, Calibration, LabelledAnswer
from tpvqa.belief.calibrating.fitting import fit
from tpvqa.episodes.fact_words import words_of
from tpvqa.errors import TpvqaError
from tpvqa.labelling.recorded import Asking, RecordedEpisode, said_in_trial
from tpvqa.labelling.rows import rows_of
from tpvqa.pddl import Action, Atom, Task
from tpvqa.pddl.conditions import literals
from tpvqa.vlm import Reply
from tpvqa.worlds import Report

WEIGHT = 0.25
"""What an inferred answer counts for, beside one that a person or a world has labelled."""
WORKS = {Report.DONE: 0.75, Report.FAILED: 0.1}
"""How often an action does what its effects say, by what its skill reports."""
CHANGES = 0.02
"""How often a fact changes between two looks although no action says so."""
SAID = 0.95
"""How often the problem's initial state is right."""
PERSON = 0.99
"""How often a person is."""
NEEDED = 20.0
"""The most that an action's success speaks for a fact that it needs (odds)."""
ROUNDS = 8
"""Of expectation maximisation, at most."""
STILL = 1e-3
"""It ends where no probability moves further than this."""

Floats = NDArray[np.float64]


@dataclass
class _Chain:
    """One fact through an episode.

    Attributes:
        atoms: The facts of which any one makes yes right.
        askings: What was asked about it, by stretch.
        initial: P(true) at first.
        moves: Of every action, P(true afterwards | false before, true before).
        seen: Evidence in every stretch, for false and for true; shape (stretches, 2).
        true: P(true) in every stretch, by all evidence.
    """

    atoms: frozenset[Atom]
    askings: dict[int, Asking]
    initial: float
    moves: Floats
    seen: Floats
    true: Floats

    def smooth(self) -> tuple[Floats, Floats]:
        """Go through it forwards and backwards.

        Returns:
            P(evidence so far and state), and P(evidence from here on | state), each but for a
            factor; shape (stretches, 2).
        """
        ahead, behind = np.empty_like(self.seen), np.empty_like(self.seen)
        ahead[0] = self.seen[0] * (1 - self.initial, self.initial)
        for k, (if_false, if_true) in enumerate(self.moves, 1):
            true = ahead[k - 1] @ (if_false, if_true)
            ahead[k] = self.seen[k] * (ahead[k - 1].sum() - true, true)
            ahead[k] /= ahead[k].sum()
        behind[-1] = self.seen[-1]
        for k in range(len(self.moves) - 1, -1, -1):
            onward = [(1 - p) * behind[k + 1, 0] + p * behind[k + 1, 1] for p in self.moves[k]]
            behind[k] = self.seen[k] * onward
            behind[k] /= behind[k].sum()
        joint = ahead * behind / self.seen
        self.true = joint[:, 1] / joint.sum(axis=1)
        return ahead, behind


@dataclass
class _Episode:
    chains: list[_Chain]
    actions: list[Action | None]
    works: list[float]


def inferred_rows(episodes: Sequence[RecordedEpisode], vlm: str) -> list[LabelledAnswer]:
    """The answers about facts, each twice: as far as yes was probably right, and as far as no.

    Args:
        episodes: Of one VLM. Those whose domain cannot be read any more tell nothing.
        vlm: Whose answers they are.
    """
    chained = [each for each in map(_chained, episodes) if each is not None]
    calibration, before = Calibration.default(vlm), np.zeros(0)
    rows: list[LabelledAnswer] = []
    for _ in range(ROUNDS):
        for episode in chained:
            _infer(episode, calibration)
        rows = [row for episode in chained for chain in episode.chains for row in _rows(chain)]
        now = np.array([row.weight for row in rows])
        if not len(now) or (len(before) and float(np.abs(now - before).max()) < STILL * WEIGHT):
            break
        before = now
        if not any(row.reply in (Reply.YES, Reply.NO) for row in rows):
            return []
        calibration = fit([replace(row, p_yes=None) for row in rows], vlm)
    return rows


def likelier(rows: Sequence[LabelledAnswer]) -> list[LabelledAnswer]:
    """Of each answer the truth that is likelier, to be counted and drawn."""
    return [row for row in rows if row.weight > WEIGHT / 2]


def _rows(chain: _Chain) -> Iterator[LabelledAnswer]:
    for stretch, asking in chain.askings.items():
        true = float(chain.true[stretch])
        for truth, probability in ((True, true), (False, 1 - true)):
            part = f"{stretch} {truth}"
            yield from rows_of(asking, truth=truth, weight=WEIGHT * probability, part=part)


def _chained(episode: RecordedEpisode) -> _Episode | None:
    """An episode's facts as chains, with the task that its log keeps."""
    try:
        book = words_of(episode.started).book
        if book is None:
            return None
        task = book.task
        initial = task.extend(frozenset(map(Atom.parse, episode.started.initial)))
        actions = [
            None if done is None else task.action(done[0].action.name, done[0].action.arguments)
            for done in episode.actions
        ]
    except TpvqaError:
        return None
    works = [
        WORKS[Report.DONE]
        if done is None or done[1] is None
        else WORKS.get(done[1].report, WORKS[Report.DONE])
        for done in episode.actions
    ]
    by_text: dict[str, dict[int, Asking]] = {}
    for asking in episode.askings:
        if asking.atoms:
            by_text.setdefault(asking.text, {})[asking.stretch] = asking
    chains = []
    for askings in by_text.values():
        atoms = frozenset(Atom.parse(text) for text in next(iter(askings.values())).atoms)
        said = SAID if atoms & initial else 1 - SAID
        moves = [
            _move(task, action, atoms, chance)
            for action, chance in zip(actions, works, strict=True)
        ]
        size = len(actions) + 1
        chains.append(
            _Chain(
                atoms,
                askings,
                said,
                np.array(moves).reshape(-1, 2),
                np.ones((size, 2)),
                np.full(size, 0.5),
            )
        )
    return _Episode(chains, actions, works)


def _move(
    task: Task, action: Action | None, atoms: frozenset[Atom], works: float
) -> tuple[float, float]:
    """P(true afterwards | false before, true before) of an action."""
    wanted = None if action is None else _wanted(action, atoms)
    if wanted is None:
        derived = any(atom.predicate in task.derived for atom in atoms)
        return (0.25, 0.75) if derived else (CHANGES, 1 - CHANGES)
    if wanted:
        return works, 1 - CHANGES
    return CHANGES, 1 - works


def _wanted(action: Action, atoms: frozenset[Atom]) -> bool | None:
    """What an action makes of a fact; None where it leaves it alone."""
    effects = {e.literal.positive for e in action.effects if e.literal.atom in atoms}
    return None if not effects else True in effects


def _infer(episode: _Episode, calibration: Calibration) -> None:
    """Set the probabilities of an episode's facts, by what answers are worth."""
    for chain in episode.chains:
        chain.seen[:] = 1.0
        for stretch, asking in chain.askings.items():
            chain.seen[stretch] *= _likelihood(asking, calibration)
    passes = [chain.smooth() for chain in episode.chains]
    for number, action in enumerate(episode.actions):
        if action is None:
            continue
        spoken = _worked(episode, passes, number, action)
        if spoken <= 1:
            continue
        for needed in literals(action.precondition):
            for chain in episode.chains:
                if needed.atom in chain.atoms and _wanted(action, chain.atoms) is None:
                    chain.seen[number, int(needed.positive)] *= spoken
    for chain in episode.chains:
        chain.smooth()


def _worked(
    episode: _Episode, passes: Sequence[tuple[Floats, Floats]], number: int, action: Action
) -> float:
    """How much what was seen afterwards speaks for an action's having been possible (odds), by the
    effect that tells most."""
    most, works = 1.0, episode.works[number]
    for chain, (ahead, behind) in zip(episode.chains, passes, strict=True):
        wanted = _wanted(action, chain.atoms)
        if wanted is None:
            continue
        before = ahead[number] / ahead[number].sum()
        stays = behind[number + 1]
        changed = float(stays[int(wanted)])
        impossible = float(before @ stays)
        possible = works * changed + (1 - works) * impossible
        most = max(most, possible / max(impossible, 1e-9))
    return min(most, NEEDED)


def _likelihood(asking: Asking, calibration: Calibration) -> tuple[float, float]:
    """P(answers | no is right), P(answers | yes is right), but for a factor."""
    logs, first = np.zeros(2), True
    rho = calibration.repeat(Apart.SAME_VIEW)
    for answer in asking.of_vlm:
        if answer.reply not in (Reply.YES, Reply.NO):
            continue
        rates = calibration.group_of(answer.way, asking.subject).rates
        yes = np.array((rates.yes_if_false, rates.yes_if_true))
        said = yes if answer.reply is Reply.YES else 1 - yes
        logs += np.log(np.clip(said, 0.01, 0.99)) * (1.0 if first else 1 - rho)
        first = False
    told = said_in_trial(asking)
    if told is not None:
        logs += np.log((1 - PERSON, PERSON) if told == "yes" else (PERSON, 1 - PERSON))
    found = np.exp(np.maximum(logs - logs.max(), -30.0))
    return float(found[0]), float(found[1])
