"""How far the filter is off, and a factored one: `python benchmarks/filter.py [--trials N]`.

Runs trials with the belief monitor, and feeds every prediction and answer to other filters beside
it: a reference that drops nothing above 1e-9, some that keep few joint states, and a factored one:
after every action one independent variable per mutex group, and one for each fact in none. Printed
for each: joint states kept, how far any fact's probability is from the reference's (95 % of all
moments, and the worst), how often the most probable state is another one, and the time relative to
the filter in use.
"""

import argparse
import time
from collections.abc import Callable, Sequence
from statistics import mean, quantiles

import numpy as np

from tpvqa.assembly import Trial
from tpvqa.belief.answers.information import Floats
from tpvqa.belief.answers.weighed import Instead
from tpvqa.belief.calibrating.calibration import AnswerRates, Calibration, Curve, Group
from tpvqa.belief.filtering.belief import MOST, SMALLEST, Belief
from tpvqa.belief.filtering.faults import FaultModel, JointState, Rates
from tpvqa.config import TrialConfig
from tpvqa.episodes import MemoryWriter
from tpvqa.monitors.belief import BeliefMonitor
from tpvqa.pddl import Action, Atom, State

TASKS = ("clean_dishes", "serve_breakfast", "eat_apple")
KEPT = (3, 10, 30)
IN_USE, REFERENCE = f"{MOST} joint states (in use)", "reference (1e-9)"


class Factored(Belief):
    """One independent variable per mutex group, and one for each fact in none."""

    def act(self, action: Action, rates: Rates) -> None:
        super().act(action, rates)
        chances, task = _marginals(self), self.model.task
        certain = frozenset(a for a, p in chances.items() if p > 1 - 1e-6)
        doubted = {a for a, p in chances.items() if 1e-6 < p <= 1 - 1e-6}
        joint: dict[State, float] = {certain: 1.0}
        while doubted:
            groups = (g.atoms & doubted for a in doubted for g in task.groups_of(a))
            variable = max(groups, key=lambda g: (len(g), sorted(g)), default=frozenset())
            variable = variable or frozenset({min(doubted)})
            doubted -= variable
            values = [(frozenset({atom}), chances[atom]) for atom in variable]
            values.append((frozenset(), max(1 - sum(p for _, p in values), 0.0)))
            grown = {s | v: w * p for s, w in joint.items() for v, p in values if w * p > 1e-9}
            joint = dict(sorted(grown.items(), key=lambda each: -each[1])[:MOST])
        self.outcome_weights = None
        self._become({self.model.number(JointState(s)): w for s, w in joint.items()})


class Beside:
    """A filter beside the one in use.

    Attributes:
        belief: It.
        seconds: What it took so far.
        states: Its joint states at every moment.
        off: The largest difference of any fact's probability from the reference's.
        others: Whether its most probable state was another one.
    """

    def __init__(self, belief: Belief):
        self.belief = belief
        self.seconds = 0.0
        self.states: list[int] = []
        self.off: list[float] = []
        self.others: list[bool] = []

    def do(self, what: Callable[[Belief], object]) -> None:
        """Let it take something in."""
        began = time.perf_counter()
        what(self.belief)
        self.seconds += time.perf_counter() - began

    def compare(self, reference: Belief) -> None:
        """Note how far it is off."""
        one, other = _marginals(self.belief), _marginals(reference)
        self.states.append(len(self.belief.weights))
        self.off.append(max(abs(one.get(a, 0) - other.get(a, 0)) for a in {*one, *other}))
        self.others.append(self.belief.most_probable()[0] != reference.most_probable()[0])


class Watched(Belief):
    """The filter in use, which passes on all that it takes in."""

    def __init__(self, model: FaultModel, others: dict[str, Beside]):
        super().__init__(model)
        self.others, self.own = others, Beside(self)

    def act(self, action: Action, rates: Rates) -> None:
        self._pass(
            lambda belief: belief.act(action, rates), lambda: Belief.act(self, action, rates)
        )

    def see(self, atoms: tuple[Atom, ...], if_true: float, if_false: float) -> float:
        self._pass(
            lambda belief: belief.see(atoms, if_true, if_false),
            lambda: Belief.see(self, atoms, if_true, if_false),
        )
        return 1.0

    def weigh_outcome(self, *, succeeded: float, failed: float, achieved: float) -> None:
        rates = {"succeeded": succeeded, "failed": failed, "achieved": achieved}
        self._pass(
            lambda belief: belief.weigh_outcome(**rates),
            lambda: Belief.weigh_outcome(self, **rates),
        )

    def open(self, atoms: tuple[Atom, ...], chance: float, instead: Instead | None = None) -> int:
        self._pass(
            lambda belief: belief.open(
                atoms, chance, instead and self._translated(belief, instead)
            ),
            lambda: Belief.open(self, atoms, chance, instead),
        )
        return 0

    def _translated(self, belief: Belief, instead: Instead) -> Instead:
        """The same by another belief's numbers, which tells nothing of the noise apart."""

        def translated(one: int, other: int) -> Floats | None:
            states = belief.model.joint_states
            more = instead(self.model.number(states[one]), self.model.number(states[other]))
            if more is None:
                return None
            return np.log([self.noise[self.told] @ np.exp(more)])

        return translated

    def _pass(self, what: Callable[[Belief], object], own: Callable[[], object]) -> None:
        for each in self.others.values():
            each.do(what)
        self.own.do(lambda _: own())
        reference = self.others[REFERENCE].belief
        for each in (self.own, *self.others.values()):
            each.compare(reference)


def _marginals(belief: Belief) -> dict[Atom, float]:
    found: dict[Atom, float] = {}
    for number, weight in belief.weights.items():
        for atom in belief.model.state(number):
            found[atom] = found.get(atom, 0.0) + weight
    return found


def trial(task: str, accuracy: float, episode: int) -> dict[str, Beside]:
    """All filters after a trial."""
    rates = AnswerRates(accuracy, 1 - accuracy, 0, 0)
    calibration = Calibration(
        vlm="oracle",
        rows=5000,
        whole=Group(rows=5000, rates=rates, curve=Curve(slope=1)),
        repeat_same_view=0,
        repeat_other_view=0,
    )
    config = TrialConfig(
        task=task,
        world="symbolic",
        vlm=f"oracle:{accuracy}",
        monitor="belief",
        episode=episode,
    )
    with Trial(config, calibration=calibration) as made:
        assert isinstance(made.monitor, BeliefMonitor)
        model = made.monitor.belief.model
        others = {REFERENCE: Beside(Belief(model, smallest=1e-9, most=10**6))}
        for most in KEPT:
            others[f"{most} joint states"] = Beside(Belief(model, smallest=SMALLEST, most=most))
        others["factored"] = Beside(Factored(model))
        watched = Watched(model, others)
        made.monitor.belief = watched
        made.monitor.evidence._belief = watched
        made.run(MemoryWriter(resumable=False, keep=False))
    return {IN_USE: watched.own, **others}


def main(arguments: Sequence[str] | None = None) -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--trials", type=int, default=20, help="of every task and accuracy")
    given = parser.parse_args(arguments)
    for accuracy in (0.6, 0.8, 0.95):
        found = [trial(t, accuracy, n) for t in TASKS for n in range(given.trials)]
        moments = sum(len(each[IN_USE].off) for each in found)
        print(f"answers right in {accuracy}: {len(found)} trials, {moments} moments")
        base = sum(each[IN_USE].seconds for each in found)
        for name in found[0]:
            mine = [each[name] for each in found]
            off = [value for each in mine for value in each.off]
            states = [value for each in mine for value in each.states]
            print(
                f"  {name:28} states {mean(states):6.1f} (max {max(states):5}); off by "
                f"{quantiles(off, n=20)[-1]:.1e} in 95 %, at most {max(off):.1e}; another state "
                f"first {mean(value for each in mine for value in each.others):.2%}; time "
                f"{sum(each.seconds for each in mine) / base:.2f}x"
            )


if __name__ == "__main__":
    main()
