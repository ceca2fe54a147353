"""From names to a trial: puts together what `run_episode` needs, and runs it."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from threading import Event as Flag
from types import TracebackType
from typing import Any

from pydantic import BaseModel

from tpvqa import __version__
from tpvqa.belief.calibration import Calibration
from tpvqa.belief.experience import Experience
from tpvqa.belief.shipped import shipped_calibration
from tpvqa.defaults import default_vlm, default_world
from tpvqa.episodes import Ended, Event, Limits, Parts, Started
from tpvqa.episodes.plugged import called
from tpvqa.episodes.recorder import Writer
from tpvqa.episodes.records import atoms
from tpvqa.errors import TpvqaError, UnknownNameError
from tpvqa.loop import run_episode
from tpvqa.monitors import Monitor
from tpvqa.pddl import Task, load_task
from tpvqa.planning import Planner
from tpvqa.plugins import Kind, load, make, make_from
from tpvqa.questions import QuestionBook
from tpvqa.tasks import find_task
from tpvqa.vlm import VLM
from tpvqa.worlds import World
from tpvqa.worlds.simulation import DISTURBANCE, FAILURE, Simulation
from tpvqa.worlds.world_file import WorldRules, load_world_file


@dataclass(frozen=True, slots=True, kw_only=True)
class TrialConfig:
    """What a trial is, in names and numbers.

    Attributes:
        task: A shipped task; or None with `domain` and `problem` given.
        domain: The user's own domain file.
        problem: The user's own problem file.
        questions: The user's questions file; without one every question is a fallback.
        world_file: What disturbances can undo, for simulated worlds.
        monitor: Specification of the monitor.
        vlm: Specification of the VLM; unused by monitors that never ask. None is "embedded", if
            it is installed, or "oracle" in a world that has no pictures.
        world: Specification of the world. None is the shipped task's own, or "symbolic".
        planner: Specification of the planner.
        seed: Decides, with `episode`, every random number.
        episode: Number of the episode under this seed.
        failure: Probability that a possible action fails.
        disturbance: Probability that a failure undoes an achieved fact.
        spontaneous: Probability that an achieved fact is undone after a success.
        limits: When to end without success.
        planning_timeout: Seconds for one call of the planner.
        action_deadline: Seconds for one action.
        calibration: What the VLM's answers are worth, for monitors that weigh them; None for the
            shipped one of this VLM, or a cautious default.
        experience: What such a monitor learned in earlier trials.
        experience_file: Where that is kept, for whoever goes on with the trial.
        options: Further keyword arguments for the plug-ins (`base_url`, `majority`, …).
    """

    task: str | None = None
    domain: str | None = None
    problem: str | None = None
    questions: str | None = None
    world_file: str | None = None
    monitor: str = "tpvqa"
    vlm: str | None = None
    world: str | None = None
    planner: str = "fast-downward"
    seed: int = 0
    episode: int = 0
    failure: float = FAILURE
    disturbance: float = DISTURBANCE
    spontaneous: float = 0.0
    limits: Limits = field(default_factory=Limits)
    planning_timeout: float = 30.0
    action_deadline: float | None = None
    calibration: Calibration | None = None
    experience: Experience | None = None
    experience_file: str | None = None
    options: dict[str, Any] = field(default_factory=dict)


class Trial:
    """A trial that is ready to run. Use it as a context manager: it ends what it started.

    Args:
        config: What the trial is.
        task: The task, where it has been loaded already.
        planner: A planner to share between trials; not closed here.
        vlm: A VLM to share between trials.
        book: The task's questions, where they have been loaded already.
        rules: What the world file says, where it has been loaded already.
        person: Answers where the monitor asks a person.
    """

    def __init__(
        self,
        config: TrialConfig,
        *,
        task: Task | None = None,
        planner: Planner | None = None,
        vlm: VLM | None = None,
        book: QuestionBook | None = None,
        rules: WorldRules | None = None,
        person: VLM | None = None,
    ):
        self.config, self._run = config, False
        self._closing: list[Callable[[], None]] = []
        try:
            self._prepare(task, planner, vlm, book, rules, person)
        except BaseException:
            self.close()
            raise

    def _prepare(
        self,
        task: Task | None,
        planner: Planner | None,
        vlm: VLM | None,
        book: QuestionBook | None,
        rules: WorldRules | None,
        person: VLM | None,
    ) -> None:
        config = self.config
        files = None if config.task is None else find_task(config.task)
        if files is None and (config.domain is None or config.problem is None):
            raise TpvqaError("Name a shipped task, or give both --domain and --problem.")
        self.domain = Path(config.domain if files is None else files.domain)  # type: ignore[arg-type]
        self.problem = Path(config.problem if files is None else files.problem)  # type: ignore[arg-type]
        self.questions = config.questions or (files.questions if files else None)
        self.world_file = config.world_file or (files.world if files else None)
        self.task = task or load_task(self.domain, self.problem)
        self.book = book or QuestionBook.load(self.questions, self.task)
        if planner is None:
            planner = make(Kind.PLANNER, config.planner)
            self._closing.append(planner.close)
        self.rules = rules or load_world_file(self.world_file, self.task)
        self.simulation = Simulation(
            self.task,
            self.rules,
            failure=config.failure,
            disturbance=config.disturbance,
            spontaneous=config.spontaneous,
            seed=config.seed,
            episode=config.episode,
        )
        context = {
            **config.options,
            "task": self.task,
            "book": self.book,
            "planner": planner,
            "rules": self.rules,
            "simulation": self.simulation,
            "seed": config.seed,
            "episode": config.episode,
        }
        self.world_spec = config.world or default_world(files)
        self.world: World
        self.world, taken = make_from(Kind.WORLD, self.world_spec, context)
        self._closing.append(self.world.close)
        truth = getattr(self.world, "truth", None)
        if truth is not None:
            context["truth"] = truth
        context["views"] = tuple(self.world.views())
        pictures = getattr(self.world, "has_pictures", True)
        named = config.vlm or (None if vlm is None else vlm.name)
        self.vlm_spec = named or default_vlm(pictures=pictures)
        calibration = config.calibration or shipped_calibration(self.vlm_spec)
        context["calibration"] = calibration
        context["experience"] = (
            None
            if config.experience is None
            else config.experience.with_vlm(self.vlm_spec, calibration)
        )
        context["limits"] = config.limits
        answering = vlm or load(Kind.VLM, self.vlm_spec.partition(":")[0].strip())
        context["noise_model"] = bool(getattr(answering, "noise_model", False))
        self.monitor: Monitor
        self.monitor, by_monitor = make_from(Kind.MONITOR, config.monitor, context)
        self.weighs_answers = "calibration" in by_monitor
        self.calibration: Calibration | None = calibration if self.weighs_answers else None
        made, by_vlm = make_from(Kind.VLM, self.vlm_spec, context) if vlm is None else (vlm, set())
        self.vlm: VLM = made
        if not pictures and getattr(self.vlm, "needs_pictures", False):
            raise TpvqaError(
                f"The VLM {self.vlm_spec!r} looks at pictures, and the world {self.world_spec!r} "
                "has none. Choose a noise model, e.g. 'oracle:0.9', or a world with pictures."
            )
        _all_taken(config.options, taken | by_monitor | by_vlm, context)
        if vlm is None and hasattr(self.vlm, "close"):
            self._closing.append(self.vlm.close)
        self.parts = Parts(self.task, self.book, planner, self.world, self.vlm, person)

    def started(self) -> Started:
        """The first event of the trial's episode."""
        config = self.config
        return Started(
            version=__version__,
            task=self.task.name,
            domain_file=str(self.domain),
            problem_file=str(self.problem),
            questions_file=None if self.questions is None else str(self.questions),
            world_file=None if self.world_file is None else str(self.world_file),
            domain=self.task.domain_text,
            problem=self.task.problem_text,
            questions=_text(self.questions),
            rules=_text(self.world_file),
            initial=atoms(self.task.init),
            goal=", ".join(self.book.fact(literal).text for literal in self._goal_literals()),
            monitor=config.monitor,
            vlm=self.vlm_spec,
            noise_model=getattr(self.vlm, "noise_model", False),
            world=self.world_spec,
            planner=self.parts.planner.name,
            seed=config.seed,
            episode=config.episode,
            limits=config.limits,
            settings={
                "shipped_task": config.task,
                "own_questions": config.questions,
                "own_world_file": config.world_file,
                "planner": config.planner,
                "failure": config.failure,
                "disturbance": config.disturbance,
                "spontaneous": config.spontaneous,
                "planning_timeout": config.planning_timeout,
                "action_deadline": config.action_deadline,
                "calibration": _plain(self.calibration),
                "experience": _plain(config.experience),
                "experience_file": config.experience_file,
                "options": config.options,
            },
        )

    def check(self) -> None:
        """See whether world and VLM are there, before a robot moves: files, keys, servers.

        Asks those that have a method `check`; the VLM only where the monitor asks anything.

        Raises:
            TpvqaError: What is missing.
        """
        asks = not getattr(self.monitor, "never_asks", False)
        for part in (self.world, self.vlm) if asks else (self.world,):
            if hasattr(part, "check"):
                called(part, "check", object)

    def run(
        self,
        writer: Writer,
        *,
        started: Started | None = None,
        recorded: Sequence[Event] = (),
        folder: Path | None = None,
        listeners: Sequence[Callable[[Event], None]] = (),
        cancel: Flag | None = None,
    ) -> Ended:
        """Run it to its end, or go on from recorded events.

        Raises:
            TpvqaError: It has run already; the world is no longer where a trial begins.
            Interrupted: Ctrl-C, which also ends a loop of trials. The log is ended first.
        """
        if self._run:
            raise TpvqaError("This trial has run already. Make another Trial to run it again.")
        self._run = True
        return run_episode(
            self.parts,
            self.monitor,
            writer,
            started or self.started(),
            recorded=recorded,
            folder=folder,
            listeners=listeners,
            planning_timeout=self.config.planning_timeout,
            action_deadline=self.config.action_deadline,
            cancel=cancel,
        )

    @property
    def experience(self) -> Experience | None:
        """What the monitor has learned, for the next trial; None where it learns nothing."""
        learned: Experience | None = getattr(self.monitor, "experience", None)
        if learned is None:
            return None
        known = "" if self.calibration is None else self.calibration.fingerprint
        return learned.model_copy(update={"vlm": self.vlm_spec, "calibration": known})

    def _goal_literals(self) -> list[Any]:
        from tpvqa.pddl import literals

        return list(literals(self.task.goal))

    def close(self) -> None:
        """End planner and world. Can be called twice."""
        while self._closing:
            self._closing.pop()()

    def __enter__(self) -> "Trial":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


def _all_taken(
    options: Mapping[str, Any], taken: Collection[str], context: Collection[str]
) -> None:
    for option in options:
        if option not in taken:
            known = set(taken) - (set(context) - set(options)) - {"arguments", "truth"}
            raise UnknownNameError("option for this world, monitor and VLM", option, known)


def _plain(model: BaseModel | None) -> dict[str, Any] | None:
    return None if model is None else model.model_dump(mode="json")


def _text(path: Path | str | None) -> str | None:
    """What a file says, to be compared with what it says later."""
    return None if path is None else Path(path).read_bytes().decode(errors="replace")
