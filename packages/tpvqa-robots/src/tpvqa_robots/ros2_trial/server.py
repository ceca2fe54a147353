"""The loop as a ROS 2 action server: `RunTask`, with `Ask`, and a trial told on topics."""

import queue
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Event as Flag
from typing import Any

from tpvqa import Trial, TrialConfig
from tpvqa.drivers import Interrupted
from tpvqa.errors import TpvqaError, WorldError
from tpvqa.events import Ended
from tpvqa_robots.ros2 import typed
from tpvqa_robots.ros2.lifecycle import Stages, begin
from tpvqa_robots.ros2.link import Link
from tpvqa_robots.ros2_trial.asking import Asking
from tpvqa_robots.ros2_trial.goal import config_of, new_folder
from tpvqa_robots.ros2_trial.publishing import Topics
from tpvqa_robots.ros2_trial.running import Running, run

TICK = 0.2
"""Seconds between two looks at whether it is to end."""
SETTLES = 1.0
"""Seconds that a result has to be sent before the node may end."""


class RunTaskServer:
    """Offers PREFIX/run_task and PREFIX/ask, and tells trials on PREFIX/episode and PREFIX/belief.

    One trial runs at a time; a goal that comes meanwhile is rejected. Trials run in the thread of
    `run`.

    Args:
        config: What a trial is where its goal does not say.
        out: The folder of the episodes' folders.
        prefix: Of the action, the service and the topics.
        managed: Whether its node waits to be configured and activated by somebody else.
        sim_time: Whether stamps are of the clock on /clock.
        say: Told in words what happens.

    Raises:
        MissingExtraError: ROS 2 is not installed.
        TpvqaError: The messages are not built.
    """

    def __init__(
        self,
        config: TrialConfig,
        out: Path,
        *,
        prefix: str = "/tpvqa",
        managed: bool = False,
        sim_time: bool = False,
        say: Callable[[str], None] = print,
    ):
        self._config, self._out, self._prefix, self._say = config, out, prefix, say
        self._wanted: queue.Queue[Any] = queue.Queue()
        self._busy, self._active, self._over = False, False, Flag()
        self._cancel = Flag()
        self._trial: Flag | None = None
        self._running: Running | None = None
        self._one = threading.Lock()
        stages = Stages(
            self._configure, self._activate, self._deactivate, self._cleanup, self.close
        )
        self._link = Link("tpvqa_run_task", stages=stages, sim_time=sim_time)
        typed.see_built("RunTask")
        self._asks: Link | None = None
        if not managed:
            begin(self._link.node)

    def run(self) -> None:
        """Serve until `close` is called.

        Raises:
            KeyboardInterrupt: Ctrl-C; a trial that ran has its end.
        """
        self._link.start()
        try:
            while not self._over.is_set():
                try:
                    handle = self._wanted.get(timeout=TICK)
                except queue.Empty:
                    continue
                self._serve(handle)
        finally:
            self._link.close()  # first: a result may still be on its way
            if self._asks is not None:
                self._asks.close()

    def close(self) -> None:
        """End the trial that runs, and then the server; from any thread."""
        self._over.set()
        self._stop_trial()

    def _stop_trial(self) -> None:
        """End the trial that runs, or is about to; without a lock, as signals call it."""
        self._cancel.set()
        if self._trial is not None:
            self._trial.set()

    def _configure(self) -> None:
        from rclpy.action import ActionServer, CancelResponse, GoalResponse
        from tpvqa_interfaces.action import RunTask
        from tpvqa_interfaces.srv import Ask

        def wanted(_: Any) -> Any:
            if self._busy or not self._active or self._over.is_set():
                why = "a trial is running" if self._busy else "the server is not active"
                self._say(f"a goal was rejected: {why}")
                return GoalResponse.REJECT
            self._busy, self._cancel, self._trial = True, Flag(), None
            return GoalResponse.ACCEPT

        def cancel(_: Any) -> Any:
            self._stop_trial()
            return CancelResponse.ACCEPT

        self._kind: Any = RunTask
        self._topics = Topics(self._link, self._prefix)
        action = ActionServer(
            self._link.node,
            RunTask,
            f"{self._prefix}/run_task",
            execute_callback=lambda _: RunTask.Result(),
            goal_callback=wanted,
            # It counts as executed when it ends: rclpy's own way would keep the node's only thread.
            handle_accepted_callback=self._wanted.put,
            cancel_callback=cancel,
        )
        self._link.keep(action.destroy)
        # A node of its own: a VLM may take long, and a cancel must not wait for it.
        self._asks = Link("tpvqa_ask")
        asking = Asking(lambda: self._running, self._looking)
        self._asks.node.create_service(Ask, f"{self._prefix}/ask", asking.answer)
        self._asks.start()

    def _activate(self) -> None:
        self._active = True

    def _deactivate(self) -> None:
        self._active = False
        self._stop_trial()

    def _cleanup(self) -> None:
        if self._busy:
            raise WorldError("a trial is still ending: clean up once it has")
        self._link.clear()
        if self._asks is not None:
            self._asks.close()
            self._asks = None

    @contextmanager
    def _looking(self) -> Iterator[Trial]:
        """A trial of whose world somebody takes a look while none runs."""
        with self._one, Trial(self._config) as trial:
            trial.check()
            yield trial

    def _serve(self, handle: Any) -> None:
        """Run the trial of a goal, and send its result."""
        interrupted = False
        with self._one, TemporaryDirectory(prefix="tpvqa-goal-") as texts:
            ended: Ended | None = None
            folder, broke = self._out / "none", ""
            try:
                config = config_of(handle.request, self._config, Path(texts))
                with Trial(config) as trial:
                    folder = new_folder(self._out, trial.task.name, config.seed)
                    self._running = Running(trial, folder)
                    ended = self._run(handle, self._running)
            except (TpvqaError, TimeoutError) as error:
                broke = str(error)
                self._say(f"the trial broke off: {broke}")
            except Interrupted as stop:
                ended, interrupted = stop.ended, True
            except KeyboardInterrupt:
                broke, interrupted = "interrupted by the user", True
            finally:
                self._running = None
        if interrupted:
            self._over.set()  # no other goal is taken
        self._finish(handle, ended, folder, broke)
        if interrupted:
            raise KeyboardInterrupt

    def _run(self, handle: Any, running: Running) -> Ended:
        name = str(running.folder)
        self._say(f"{running.trial.task.name}: {name}")

        def feedback(now: Any) -> None:
            handle.publish_feedback(self._kind.Feedback(now=now))

        def stopped_by(flag: Flag) -> None:
            """Have whoever cancels set the trial's own flag, who did so just now, too."""
            self._trial = flag
            if self._cancel.is_set():
                flag.set()

        return run(running, self._topics.told(name, feedback), stopped_by)

    def _finish(self, handle: Any, ended: Ended | None, folder: Path, broke: str) -> None:
        result, sent, late = self._kind.Result(message=broke), Flag(), Flag()
        result.episode = str(folder) if folder.is_dir() else ""
        if ended is not None:
            reached = ended.believed_goal if ended.completed is None else ended.completed
            result.completed, result.believed_goal = bool(reached), bool(ended.believed_goal)
            result.because, result.message = ended.ending, ended.message
            for name in ("actions", "questions", "looks", "repeats", "replans"):
                setattr(result, name, getattr(ended, name))
            self._say(f"{ended.ending}: {folder}")

        def finish(goal: Any) -> Any:
            if result.completed:
                goal.succeed()
            elif goal.is_cancel_requested:
                goal.canceled()
            else:
                goal.abort()
            if not late.is_set():
                self._busy = False  # whoever hears the result may send the next goal at once
            sent.set()
            return result

        handle.execute(finish)
        if not sent.wait(SETTLES):
            late.set()
            self._busy = False
            print("the result of a goal could not be sent", file=sys.stderr)
