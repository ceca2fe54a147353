"""From names to a trial: puts together what it needs, and hands it to whatever drives it."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from threading import Event as Flag
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

from tpvqa import __version__
from tpvqa.assembly.answering import answering
from tpvqa.assembly.grounding import grounded
from tpvqa.assembly.lasting import see_lasting, watching
from tpvqa.assembly.numbers import see_numbers
from tpvqa.assembly.reach import asking
from tpvqa.assembly.simulating import simulate
from tpvqa.assembly.told import read_told, see_fitting, stated_bound
from tpvqa.assembly.wanting import see_wanted
from tpvqa.belief.calibrating.calibration import Calibration
from tpvqa.belief.calibrating.risk import RiskBound
from tpvqa.belief.calibrating.shipped import shipped_calibration
from tpvqa.belief.filtering.priors import Priors, load_priors
from tpvqa.belief.filtering.starts import opened
from tpvqa.belief.learning.experience import Experience
from tpvqa.config import SimulationConfig, TrialConfig
from tpvqa.defaults import default_vlm, default_world
from tpvqa.drivers import Journal, Listener, Parts, Performer, SteppingTrial
from tpvqa.drivers import run as run_live
from tpvqa.drivers.journal import Writer
from tpvqa.drivers.plugged import called, put_back, views_of
from tpvqa.drivers.replaying import Recording
from tpvqa.drivers.sensed import senses_of
from tpvqa.errors import PluginError, TpvqaError
from tpvqa.events import Ended, Event, Started
from tpvqa.events.records import atoms
from tpvqa.monitors import Monitor
from tpvqa.monitors.capabilities import experience_of, never_asks
from tpvqa.monitors.making import make_monitor
from tpvqa.pddl import Task, literals
from tpvqa.planning import Planner
from tpvqa.planning.making import make_planner
from tpvqa.plugins import Checked, Closing, Kind, load_spec, see_free
from tpvqa.questions import QuestionBook
from tpvqa.tasks import domain_and_problem, find_task
from tpvqa.text_files import kept_text
from tpvqa.trial import trial
from tpvqa.vlm import VLM
from tpvqa.vlm.capabilities import is_noise_model, parameters_of
from tpvqa.vlm.making import in_full
from tpvqa.worlds import Restorable, World
from tpvqa.worlds.capabilities import has_pictures, true_start, truth_of
from tpvqa.worlds.making import make_world
from tpvqa.worlds.world_file import WorldRules, load_world_file

if TYPE_CHECKING:
    from tpvqa.belief.filtering.faults import FaultModel
    from tpvqa.drivers.asynchronous import AsynchronousTrial


class Trial:
    """A trial that is ready to run. Use it as a context manager: it ends what it started.

    Args:
        config: What the trial is.
        task: The task, where it has been loaded already.
        planner: A planner to share between trials; not closed here.
        vlm: A VLM to share between trials.
        book: The task's questions, where they have been loaded already.
        rules: What the world file says, where it has been loaded already.
        priors: What is said of the initial state, likewise.
        model: The action model, where trials one after the other share it.
        calibration: What the VLM's answers are worth; goes before the file that `config` names,
            and that before the one that is shipped for this VLM.
        experience: What was learned in earlier trials; goes before the file that `config` names.
        risk: Where "done" may be reported; goes before the file that `config` names.
        reading: Whether to read the files of these that `config` names.
        person: Answers where the monitor asks a person.
        begun_as: The first event, where the trial was begun before.
        every_option: Whether each of the config's options has to be one that a plug-in takes.

    Example:
        >>> config = TrialConfig(task="build_tower", vlm="oracle:0.9", world="symbolic")
        >>> with Trial(config) as trial:  # doctest: +SKIP
        ...     trial.run(MemoryWriter()).completed
        True
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
        priors: Priors | None = None,
        model: "FaultModel | None" = None,
        calibration: Calibration | None = None,
        experience: Experience | None = None,
        risk: RiskBound | None = None,
        reading: bool = True,
        person: VLM | None = None,
        begun_as: Started | None = None,
        every_option: bool = True,
    ):
        self.config, self._run, self._every_option = config, False, every_option
        self._begun_as = begun_as
        self._closing: list[Callable[[], None]] = []
        try:
            self._find_files()
            self.task = task or grounded(self.domain, self.problem, config.planner)
            book = book or QuestionBook.load(self.questions, self.task)
            self.rules = rules or load_world_file(self.world_file, self.task)
            self.priors = priors or load_priors(self.task, config.start.priors, config.start.what)
            known, self.task = self.task, opened(self.task, self.priors)
            self.book = asking(book.worded(config.wording), self.task, self.rules, self.priors)
            model = model if self.task is known else None  # that of what was reachable before
            if reading:
                calibration, experience = read_told(config.monitor, calibration, experience)
            self._make(planner, vlm, model, calibration, experience, risk, person)
        except BaseException:
            self.close()
            raise

    def _find_files(self) -> None:
        wanted = self.config.task
        files = None if wanted.name is None else find_task(wanted.name)
        own = domain_and_problem(wanted.domain, wanted.problem)
        domain, problem = own if files is None else (files.domain, files.problem)
        if domain is None or problem is None:
            raise TpvqaError("Name a shipped task, or give both --domain and --problem.")
        self.domain, self.problem = Path(domain), Path(problem)
        self.questions = wanted.questions or (files.questions if files else None)
        self.world_file = wanted.world_file or (files.world if files else None)

    def _make(
        self,
        planner: Planner | None,
        vlm: VLM | None,
        model: "FaultModel | None",
        calibration: Calibration | None,
        experience: Experience | None,
        risk: RiskBound | None,
        person: VLM | None,
    ) -> None:
        config = self.config
        options = config.plugin_options()
        if planner is None:
            planner = make_planner(config.planner.spec)
            self._closing.append(planner.close)
        planner = watching(self.task, planner, every=config.monitor.watch)
        files = None if config.task.name is None else find_task(config.task.name)
        self.world_spec = config.world.spec or default_world(files)
        self.simulation = simulate(
            self.world_spec, self.task, self.rules, config, planner, self._begun_as, self.priors
        )
        context = {
            **options,
            "task": self.task,
            "book": self.book,
            "planner": planner,
            "rules": self.rules,
            "priors": self.priors,
            "script_file": None if files is None else files.script,
            "simulation": self.simulation,
            "model": model,
            "limits": config.limits,
            "seed": config.seed,
            "episode": config.episode,
        }
        see_free(config.options, context)
        world, by_world = make_world(self.world_spec, context)
        self._closing.append(world.close)
        senses = senses_of(world, self.task)
        context |= {"truth": truth_of(world), "views": views_of(world), "senses": senses}
        named = config.vlm.spec or (None if vlm is None else vlm.name)
        named = named or default_vlm(files, pictures=has_pictures(world))
        self.vlm_spec = in_full(named) if vlm is None else named
        self.known = experience
        self.calibration = calibration or shipped_calibration(self.vlm_spec)
        self.risk = stated_bound(self, risk, reading=self._begun_as is None)
        noise_model = is_noise_model(vlm or load_spec(Kind.VLM, self.vlm_spec))
        self.book = self.book.of_states() if noise_model else self.book
        context |= {
            "book": self.book,
            "risk": self.risk,
            "calibration": self.calibration,
            "experience": None
            if self.known is None
            else self.known.with_vlm(self.vlm_spec, self.calibration),
            "noise_model": noise_model,
        }
        self.monitor: Monitor
        self.monitor, by_monitor = make_monitor(config.monitor.named, context)
        see_lasting(self.task, world, self.monitor)
        see_numbers(self.task, planner, self.monitor)
        self.weighs_answers = "calibration" in by_monitor
        if not self.weighs_answers:
            self.calibration = None
        made, by_vlm = answering(self, vlm, context)
        see_fitting(self, made, world, self._begun_as)
        if self._every_option:
            see_wanted(self, options, by_world | by_monitor | by_vlm, context)
        if made is not vlm and isinstance(made, Closing):
            self._closing.append(made.close)
        self.parts = Parts(self.task, self.book, planner, world, made, person)

    @property
    def world(self) -> World:
        """Where the robot acts."""
        return self.parts.world

    @property
    def vlm(self) -> VLM:
        """Who answers."""
        return self.parts.vlm

    def started(self) -> Started:
        """The first event of the trial's episode."""
        if self._begun_as is not None:
            return self._begun_as.model_copy(update={"number": -1, "time": 0.0})
        faults = self.simulation and (self.config.simulation or SimulationConfig())
        goal = (self.book.fact(literal).text for literal in literals(self.task.goal))
        told, known, risk = self.calibration, self.known, self.risk
        return Started(
            version=__version__,
            config=self.config.model_copy(update={"simulation": faults}),
            task=self.task.name,
            monitor=self.config.monitor.named,
            vlm=self.vlm_spec,
            world=self.world_spec,
            planner=self.parts.planner.name,
            noise_model=is_noise_model(self.vlm),
            domain_file=str(self.domain),
            problem_file=str(self.problem),
            questions_file=None if self.questions is None else str(self.questions),
            world_file=None if self.world_file is None else str(self.world_file),
            domain=self.task.domain_text,
            problem=self.task.problem_text,
            questions=kept_text(self.questions),
            rules=kept_text(self.world_file),
            priors=kept_text(self.config.start.priors),
            initial=atoms(self.task.init),
            true_start=self._true_start,
            goal=", ".join(goal),
            calibration=None if told is None else told.model_dump(mode="json"),
            experience=None if known is None else known.model_dump(mode="json"),
            risk=None if risk is None else risk.model_dump(mode="json"),
            parameters=parameters_of(self.vlm) or None,
        )

    @property
    def _true_start(self) -> tuple[str, ...] | None:
        """The facts that truly hold at first; None where they are those of the problem."""
        start = true_start(self.world, self.task)
        return None if start == self.task.init else atoms(start)

    def check(self) -> None:
        """See whether world and VLM are there, before a robot moves: files, keys, servers.

        The VLM is only looked for where the monitor asks anything.

        Raises:
            TpvqaError: What is missing.
        """
        for part in (self.world,) if never_asks(self.monitor) else (self.world, self.vlm):
            if isinstance(part, Checked):
                called(part, "check", object)

    def run(
        self,
        writer: Writer,
        *,
        started: Started | None = None,
        recorded: Sequence[Event] = (),
        folder: Path | None = None,
        listeners: Sequence[Listener] = (),
        cancel: Flag | None = None,
    ) -> Ended:
        """Run it to its end, or go on from recorded events.

        Args:
            writer: Where events go.
            started: The first event, where it is gone on with.
            recorded: The events so far, where it is gone on with.
            folder: Where its pictures lie.
            listeners: Told of every event, recorded ones too.
            cancel: Set from another thread to end the trial.

        Raises:
            TpvqaError: It has run already; the world is no longer where a trial begins.
            Interrupted: Ctrl-C, which also ends a loop of trials. The log is ended first.
        """
        stepping = self.stepping(
            writer, started=started, recorded=recorded, folder=folder, listeners=listeners
        )
        return run_live(stepping, self.performer(writer, cancel=cancel))

    def stepping(
        self,
        writer: Writer,
        *,
        started: Started | None = None,
        recorded: Sequence[Event] = (),
        folder: Path | None = None,
        listeners: Sequence[Listener] = (),
    ) -> SteppingTrial:
        """The trial one request at a time; arguments and errors as of `run`."""
        if self._run:
            raise TpvqaError("This trial has run already. Make another Trial to run it again.")
        self._run = True
        return SteppingTrial(
            trial(
                self.task,
                self.book,
                self.monitor,
                self.started() if started is None else started.model_copy(),
            ),
            Journal(writer, listeners),
            recording=Recording(recorded, self.task, folder) if recorded else None,
            restore=self._restore,
        )

    def asynchronous(
        self,
        writer: Writer,
        *,
        started: Started | None = None,
        recorded: Sequence[Event] = (),
        folder: Path | None = None,
        listeners: Sequence[Listener] = (),
        cancel: Flag | None = None,
    ) -> "AsynchronousTrial":
        """The trial as an asynchronous iterator of its events; arguments and errors as of `run`."""
        from tpvqa.drivers.asynchronous import AsynchronousTrial

        stepping = self.stepping(
            writer, started=started, recorded=recorded, folder=folder, listeners=listeners
        )
        return AsynchronousTrial(stepping, self.performer(writer, cancel=cancel))

    def performer(self, writer: Writer, *, cancel: Flag | None = None) -> Performer:
        """What does what the trial asks for.

        Args:
            writer: Where pictures go.
            cancel: Set from another thread to end the trial.
        """
        return Performer(
            self.parts,
            save_frame=writer.save_frame,
            snapshots=writer.resumable,
            planning_timeout=self.config.planner.timeout,
            action_deadline=self.config.limits.action_seconds,
            cancel=cancel,
        )

    def _restore(self, snapshots: Mapping[str, Mapping[str, Any]]) -> bool:
        """Put world and VLM where the log left them; whether the world can be put back."""
        for name, part in (("world", self.world), ("vlm", self.vlm)):
            if isinstance(part, Restorable) and name in snapshots:
                put_back(part, name, snapshots[name])
        return isinstance(self.world, Restorable)

    @property
    def experience(self) -> Experience | None:
        """What the monitor has learned, for the next trial; None where it learns nothing."""
        learned = experience_of(self.monitor)
        known = "" if self.calibration is None else self.calibration.fingerprint
        told = {"vlm": self.vlm_spec, "calibration": known, "domain": self.task.domain_name}
        return None if learned is None else learned.model_copy(update=told)

    def close(self) -> None:
        """End planner and world. Can be called twice.

        Raises:
            PluginError: One of them broke; the others are ended all the same.
        """
        broken: Exception | None = None
        while self._closing:
            try:
                self._closing.pop()()
            except Exception as error:  # noqa: BLE001 — whatever a plug-in raises
                broken = broken or error
        if isinstance(broken, TpvqaError):
            raise broken
        if broken is not None:
            kind = type(broken).__name__
            raise PluginError(f"closing broke: {kind}: {broken}. The episode is whole") from broken

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
