"""A trial as a Gymnasium environment: whoever acts in it decides what to ask and how to go on.

Importing this registers `tpvqa/CollectToys-v0`: `gymnasium.make` finds it by
`tpvqa_robots.bridges.gym:tpvqa/CollectToys-v0`, too.
"""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tpvqa import Trial, TrialConfig
from tpvqa.belief.costs import Costs
from tpvqa.drivers import Performer, SteppingTrial
from tpvqa.drivers.early import EARLY, concluded
from tpvqa.drivers.performing import Performed
from tpvqa.episodes import EpisodeWriter, MemoryWriter
from tpvqa.errors import MissingExtraError, TpvqaError
from tpvqa.monitors import Ask, Look
from tpvqa.pictures import in_colour
from tpvqa.trial import Act, Conclusion
from tpvqa_robots.bridges.commanded import Command, Commanded

try:
    import gymnasium
    from gymnasium import spaces
except ImportError as error:
    raise MissingExtraError(
        "gymnasium", "gym", "A trial as an environment", distribution="tpvqa-robots"
    ) from error

Observed = dict[str, Any]
FAILED = 50.0
"""What a trial costs that ends without its goal, in actions: as the belief monitor has it."""


class GroundedTask(gymnasium.Env[Observed, np.int64]):
    """One trial an episode. The planner plans; the agent stands in the monitor's place.

    **Actions** (`Discrete`): ask one of `questions` about the latest picture, or one of `commands`:
    look again, go on with the plan, repeat the last action, replan from what is most probable, say
    that the goal is reached, give up. Every check, before and after an action, begins with a look.

    **Observations** (`Dict`): `picture` (height × width × 3, the view that is looked from; grey
    where a world has none), `belief` (a probability for each of `facts`), `skill` (which of
    `skills` the plan has at this step), `acted` (1 after it, 0 before).

    **Rewards** are costs: an action 1, a question .05, a look .005, and 50 for a trial that ends
    without its goal. `info` says whether the goal holds in truth (`completed`), and what was said.

    Args:
        config: The trial; its monitor is replaced.
        size: Height and width of the picture.
        most: Steps in an episode, before it is truncated.
        folder: Where episodes are logged, each in a folder of its own; nowhere by default.
        render_mode: `rgb_array` or None.

    Raises:
        TpvqaError: The task, the world or the VLM cannot be made.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 4}  # noqa: RUF012 — as its base has it

    def __init__(
        self,
        config: TrialConfig,
        *,
        size: tuple[int, int] = (120, 160),
        most: int = 400,
        folder: Path | None = None,
        render_mode: str | None = None,
    ):
        self.config = config.model_copy(
            update={"monitor": TrialConfig(monitor="commanded").monitor}
        )
        self.render_mode, self._size, self._most = render_mode, size, most
        self._folder, self._seed, self._episode = folder, config.seed, config.episode
        self._costs = Costs()
        with Trial(self.config) as trial:
            monitor = _commanded(trial)
            self.facts = sorted(
                atom for atom in trial.task.reachable_atoms if atom.predicate in trial.task.fluents
            )
            self.questions = monitor.questions
            self.skills = sorted(f"({' '.join(words)})" for words in trial.task.reachable_actions)
        self.commands = tuple(Command)
        self._numbers = {pddl: number for number, pddl in enumerate(self.skills)}
        self.action_space = spaces.Discrete(len(self.questions) + len(self.commands))
        self.observation_space = spaces.Dict(
            {
                "picture": spaces.Box(0, 255, (*size, 3), np.uint8),
                "belief": spaces.Box(0.0, 1.0, (len(self.facts),), np.float32),
                "skill": spaces.Discrete(len(self.skills)),
                "acted": spaces.Discrete(2),
            }
        )
        self._trial: Trial | None = None

    def command(self, which: Command) -> np.int64:
        """The number of a command."""
        return np.int64(len(self.questions) + self.commands.index(which))

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observed, dict[str, Any]]:
        """Begin a trial: of a seed its first episode, or the next one of the seed before."""
        super().reset(seed=seed)
        self._end()
        self._seed, self._episode = (
            (self._seed, self._episode + 1) if seed is None else (seed, self.config.episode)
        )
        self._trial = trial = Trial(
            self.config.model_copy(update={"seed": self._seed, "episode": self._episode})
        )
        trial.check()
        self._log = writer = self._writer()
        self._monitor, self._steps = _commanded(trial), 0
        self._picture = np.full((*self._size, 3), 128, np.uint8)
        self._stepping: SteppingTrial = trial.stepping(writer)
        self._performer: Performer = trial.performer(writer)
        self._held: Performed | None = None
        self._early: Conclusion | None = None
        self._stepping.begin()
        self._go_on()
        return self._observed(), {"said": ""}

    def step(self, action: np.int64) -> tuple[Observed, float, bool, bool, dict[str, Any]]:
        """Ask, look or decide.

        Raises:
            TpvqaError: The episode has not begun or is over, or world or VLM cannot go on.
        """
        if self._trial is None or self._held is None:
            raise TpvqaError("The episode is over: call reset().")
        number, known = int(action), len(self.questions)
        commanded = self.questions[number] if number < known else self.commands[number - known]
        self._monitor.command = commanded
        held, self._held, self._said = self._held, None, ""
        self._stepping.send(held)
        spent = self._go_on()
        self._steps += 1
        over = self._early is not None or self._stepping.pending is None
        info: dict[str, Any] = {"said": self._said, "commanded": str(commanded)}
        if over:
            ended = self._stepping.end(
                self._early, goal_holds=self._performer.goal_holds(), unmet=self._performer.unmet()
            )
            info |= {"because": ended.because, "completed": bool(ended.completed)}
            spent += 0.0 if ended.completed else FAILED
        truncated = not over and self._steps >= self._most
        return self._observed(), -spent, over, truncated, info

    def render(self) -> NDArray[np.uint8] | None:
        """The latest picture."""
        return self._picture.copy() if self.render_mode == "rgb_array" else None

    def close(self) -> None:
        """End planner, world and VLM."""
        self._end()

    def _go_on(self) -> float:
        """Do what is pending up to the next look or answer; what that cost."""
        spent, trial, monitor = 0.0, self._stepping, self._monitor
        while trial.pending is not None:
            trial.begun()
            request = trial.pending.request
            try:
                done = self._performer.perform(trial.pending)
            except EARLY as error:
                self._early = concluded(error)
                return spent
            if isinstance(request, Look):
                monitor.looked(done.value)
                self._show(done)
                self._held = done
                return spent + self._costs.look
            if isinstance(request, Ask):
                monitor.answered(done.value)
                self._said = " ".join(f"{a.question.text} {a.reply}" for a in done.value)
                self._held = done
                return spent + self._costs.question
            spent += self._costs.action if isinstance(request, Act) else 0.0
            trial.send(done)
        return spent

    def _show(self, done: Performed) -> None:
        frame = next(iter(done.value.frames.values()), None)
        if frame is not None:
            picture = in_colour(frame.data).resize(self._size[::-1])
            self._picture = np.asarray(picture, np.uint8).copy()

    def _observed(self) -> Observed:
        state = self._stepping.state
        likely = self._monitor.belief.probabilities(self.facts)
        steps = () if state.plan is None else state.plan.plan
        now = steps[min(state.index, len(steps) - 1)].pddl() if steps else self.skills[0]
        return {
            "picture": self._picture.copy(),
            "belief": np.array([likely[fact] for fact in self.facts], np.float32),
            "skill": np.int64(self._numbers[now]),
            "acted": np.int64(state.when == "after"),
        }

    def _writer(self) -> EpisodeWriter | MemoryWriter:
        if self._folder is None:
            return MemoryWriter()
        return EpisodeWriter(self._folder / f"seed{self._seed}-episode{self._episode}")

    def _end(self) -> None:
        """End what runs, the log of an episode that was left in its middle too."""
        trial, self._trial = self._trial, None
        if trial is None:
            return
        if self._held is not None:
            self._stepping.journal.write(self._held.event)
            self._held = None
        if self._stepping.state.ended is None:
            self._stepping.end(
                self._early, goal_holds=self._performer.goal_holds(), unmet=self._performer.unmet()
            )
        self._log.close()
        trial.close()


def _commanded(trial: Trial) -> Commanded:
    assert isinstance(trial.monitor, Commanded)
    return trial.monitor


def collect_toys(
    vlm: str = "oracle:0.95", world: str = "toys:slip=0.25:bad=0.25", **more: Any
) -> GroundedTask:
    """The toys of the paper's appendix on the simulated robot.

    Args:
        vlm: Who answers; noise models know the truth of the simulation.
        world: The world, with how often something is made to go wrong.
        more: See `GroundedTask`.
    """
    return GroundedTask(TrialConfig(task="collect_toys", vlm=vlm, world=world), **more)


gymnasium.register(id="tpvqa/CollectToys-v0", entry_point=f"{__name__}:collect_toys")
