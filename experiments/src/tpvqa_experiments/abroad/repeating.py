"""What repetition alone can do: who sees in truth whatever can be seen, and does the rest K times.

It knows the rates of faults, and after every action, without an error, each fact that some question
is about or some sensor tells. What nothing shows it keeps probable, in the monitor's own filter. A
step of which nothing shows whether it did anything it does several times in a row; then it goes on
from the joint state that is most probable. In the end, while the goal is not probable enough, it
goes back to what may have come undone unseen.
"""

from collections.abc import Sequence
from dataclasses import asdict, replace

from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.faults import JointState, Rates
from tpvqa.belief.filtering.sight import Sight
from tpvqa.belief.weighing.evidence import NOTICED
from tpvqa.bench.cell import Cell
from tpvqa.bench.row import EpisodeRow
from tpvqa.bench.stage import Stage, true_simulation
from tpvqa.config import TrialConfig
from tpvqa.pddl import Action, Atom, Literal, State, literals
from tpvqa.planning import Plan, Planner
from tpvqa.worlds.sensing import Occasion
from tpvqa.worlds.simulation import Redo, Simulation
from tpvqa_experiments.abroad.parts import SEEING
from tpvqa_experiments.abroad.seeing import ACTING

SURE = 0.9
"""It ends where the goal is reached with this probability."""
AIM = 0.97
"""Where it is not, so much is done again that it will be with this one."""
SMALLEST, MOST = 1e-9, 3000
"""Joint states are dropped below this probability, and above this number."""


def repeating(here: Stage, cell: Cell, common: TrialConfig, episode: int) -> EpisodeRow:
    """One episode of who sees what can be seen; the cell's monitor says how often it does the rest.

    Args:
        here: The stage of the cell's task.
        cell: Task, world and condition, and `seeing:K`.
        common: What all cells share.
        episode: Its number.

    Raises:
        TpvqaError: The trial cannot be made.
    """
    times = int(cell.monitor.removeprefix(f"{SEEING}:"))
    config = Cell(cell.task, ACTING, cell.vlm, cell.world, cell.condition).config(common, episode)
    row = {**asdict(cell), "seed": common.seed, "episode": episode}
    with here.trial(config) as trial:
        known = _Known(here, true_simulation(trial))
        planner, timeout = trial.parts.planner, config.planner.timeout
        plan = known.plan(planner, timeout)
        first = len(plan or ())
        most = config.limits.actions_of(first)
        actions = replans = 0
        while actions < most:
            if not plan and known.doubts():
                replans, plan = replans + 1, known.plan(planner, timeout)
            if not plan:
                break
            action, wanted = plan[0], times if known.hidden(plan[0]) else 1
            expected = known.task.apply(known.state, action)
            for tries in range(1, wanted + 1):
                known.do(action)
                actions += 1
                if tries < wanted and not known.may_go_on(action):
                    break
            if known.state == expected:
                plan = plan[1:]
            else:
                replans += 1
                plan = known.plan(planner, timeout)
        simulation = known.simulation
        completed = simulation.task.goal_holds(simulation.state)
        believed = known.task.goal_holds(known.state)
    return EpisodeRow(
        **row,
        completed=completed and believed,
        because="goal" if believed else "limit of actions" if plan else "no plan",
        believed_goal=believed,
        actions=actions,
        failures=known.failures,
        replans=replans,
        first_plan=first,
    )


class _Known:
    """What is known of a simulation whose hidden part is not told."""

    def __init__(self, here: Stage, simulation: Simulation):
        self.simulation, self.task, self.failures = simulation, simulation.task, 0
        rules, schemas = simulation.rules, simulation.task.schemas
        lasting = {
            r.fact.predicate for r in rules.sensed if r.at & {Occasion.ACTION, Occasion.LOOK}
        }
        felt = {r.fact.predicate for r in rules.sensed if Occasion.EFFECT in r.at}
        for report in rules.reports:
            if report.notices >= NOTICED:
                felt |= {
                    effect.literal.predicate
                    for schema in schemas
                    if report.action in (None, schema.name)
                    for effect in schema.effects
                }
        self._belief = Belief(here.model, smallest=SMALLEST, most=MOST)
        self._sight = Sight(self._belief.model)
        self._sight.by(
            lambda atom: here.book.asked(Literal(atom)) or atom.predicate in lasting,
            lambda atom: atom.predicate in felt,
        )
        rates = Rates(simulation.failure, simulation.disturbance, simulation.spontaneous)
        risky = simulation.redo is Redo.RISKY
        self._rates = replace(rates, redone=rates.undone if risky else 0.0)
        self._unseen = [
            each.atom for each in literals(self.task.goal) if not self._sight.sees(each.atom)
        ]
        self._doubted: list[Atom] = []

    @property
    def state(self) -> State:
        """The most probable joint state, but for what is doubted: that is taken to have come
        undone as is most probable."""
        likely = found = self._belief.most_probable()[0]
        for atom in self._doubted:
            without = (state for state, _ in self._belief.states() if atom not in state)
            other = next(without, likely - {atom})
            changed = {each for each in likely ^ other if not self._sight.sees(each)}
            found = found ^ changed
        return found

    def doubts(self) -> bool:
        """Whether something of the goal is to be done again, as it may have come undone unseen."""
        if self._belief.where(self.task.goal_holds) < SURE:
            self._doubted = self._doubtful(self._unseen)
        return bool(self._doubted)

    def _doubtful(self, atoms: Sequence[Atom]) -> list[Atom]:
        """Those of some facts that have to be done again so that the goal is probable enough."""
        found, likely = list[Atom](), 1.0
        for each in sorted(self._unseen, key=self._belief.probability, reverse=True):
            likely *= self._belief.probability(each)
            if likely < AIM and each in atoms:
                found.append(each)
        return found

    def hidden(self, action: Action) -> bool:
        """Whether nothing shows that an action did anything."""
        return self._sight.hidden(action)

    def do(self, action: Action) -> None:
        """Do it, and see what can be seen."""
        outcome = self.simulation.execute(action)
        self.failures += not outcome.succeeded or outcome.undone is not None
        belief, model, sight = self._belief, self._belief.model, self._sight
        belief.act(action, self._rates)
        true = model.number(JointState(self.simulation.state))
        looks = sight.look(true, action)
        belief.weigh(lambda number: float(sight.look(number, action) == looks))
        self._doubted = self._doubtful(self._doubted)

    def may_go_on(self, action: Action) -> bool:
        """Whether one more try could do something, if the tries until now have not."""
        belief, leads_to = self._belief, self._belief.model.outcomes(action)
        undone = {n: w for n, w in belief.weights.items() if not leads_to[n].achieved}
        possible = sum(w for n, w in undone.items() if leads_to[n].intended is not None)
        return possible > sum(undone.values()) / 2

    def plan(self, planner: Planner, timeout: float) -> list[Action] | None:
        """A plan from the most probable joint state."""
        found = planner.plan(self.task, self.state, timeout=timeout)
        return list(found.actions) if isinstance(found, Plan) else None
