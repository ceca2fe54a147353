"""A node of ROS 2 with a thread of its own, that ends cleanly whatever happens around it."""

import sys
import threading
import traceback
from collections.abc import Callable
from typing import Any

from tpvqa.errors import MissingExtraError, WorldError
from tpvqa_robots.ros2.lifecycle import Stages, managed_node


def load_rclpy() -> Any:
    """ROS 2's client library.

    Raises:
        MissingExtraError: It is not installed.
    """
    try:
        import rclpy
        import sensor_msgs.msg  # noqa: F401
        import std_msgs.msg  # noqa: F401
    except ImportError as error:
        raise MissingExtraError(
            "rclpy", "ros2", "A robot behind ROS 2", distribution="tpvqa-robots"
        ) from error
    return rclpy


class Link:
    """A node, its publishers and subscriptions, spun in a thread.

    Signals are left to whoever runs the program: `close` ends everything, also after Ctrl-C.

    Args:
        name: Of the node.
        stages: What it does at each stage of its life, where it is a managed node.
        sim_time: Whether its clock is that of the topic /clock.

    Raises:
        MissingExtraError: ROS 2 is not installed.
        WorldError: The node cannot be made.
    """

    def __init__(self, name: str, *, stages: Stages | None = None, sim_time: bool = False):
        rclpy = load_rclpy()
        from rclpy.clock import Clock, ClockType
        from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
        from rclpy.parameter import Parameter
        from rclpy.signals import SignalHandlerOptions

        self._ended = ExternalShutdownException
        self._context = rclpy.Context()
        try:
            rclpy.init(context=self._context, signal_handler_options=SignalHandlerOptions.NO)
            more: dict[str, Any] = {"context": self._context, "enable_rosout": False}
            if sim_time:
                more["parameter_overrides"] = [Parameter("use_sim_time", value=True)]
            make = rclpy.create_node if stages is None else managed_node(stages)
            self.node = make(name, **more)
        except Exception as error:
            self._context.try_shutdown()
            raise WorldError(
                f"No ROS 2 node can be made ({type(error).__name__}: {error}); see "
                "RMW_IMPLEMENTATION and ROS_DOMAIN_ID."
            ) from error
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._thread = threading.Thread(target=self._spin, name=name, daemon=True)
        self._closed = False
        # Beats have to go on where simulated time stands still.
        self._steady = Clock(clock_type=ClockType.STEADY_TIME)
        self._made: list[Callable[[], Any]] = []

    def start(self) -> None:
        """Begin to listen; what is subscribed to beforehand misses nothing."""
        self._thread.start()

    def _spin(self) -> None:
        while not self._closed and self._context.ok():
            try:
                self._executor.spin_once(timeout_sec=0.1)
            except self._ended:
                return
            except Exception as error:  # noqa: BLE001 — one bad message must not make it deaf
                traceback.print_exception(error, file=sys.stderr)

    def now(self) -> float:
        """Seconds by the clock that stamps are of."""
        return float(self.node.get_clock().now().nanoseconds) / 1e9

    def listen(self, kind: Any, topic: str, heard: Callable[[Any], None], qos: Any) -> None:
        """Have messages of a topic given to a function."""
        made = self.node.create_subscription(kind, topic, heard, qos)
        self._made.append(lambda: self.node.destroy_subscription(made))

    def heed(self, kind: Any, topic: str, heard: Callable[[Any], None]) -> None:
        """Have what must not be missed given to a function, from before it listened, too, where the
        sender keeps that for who comes late."""
        from rclpy.event_handler import SubscriptionEventCallbacks

        self.listen(kind, topic, heard, said())
        silent = SubscriptionEventCallbacks(incompatible_qos=lambda _: None)  # who does not keep it
        made = self.node.create_subscription(kind, topic, heard, latched(), event_callbacks=silent)
        self._made.append(lambda: self.node.destroy_subscription(made))

    def watch(self, kind: Any, topic: str, heard: Callable[[Any], None]) -> None:
        """Have the latest message of a topic given to a function, however it is sent.

        It is read reliably: large pictures come in many pieces, of which best effort loses some.
        Whoever sends by best effort is not heard that way, so it is then read so as well.
        """
        from rclpy.event_handler import SubscriptionEventCallbacks

        unheard = True

        def incompatible(_: Any) -> None:
            nonlocal unheard
            if unheard:
                unheard = False
                self.node.create_subscription(kind, topic, heard, seen())

        events = SubscriptionEventCallbacks(incompatible_qos=incompatible)
        self.node.create_subscription(kind, topic, heard, said(1), event_callbacks=events)

    def speaker(self, kind: Any, topic: str, qos: Any) -> Any:
        """A publisher."""
        made = self.node.create_publisher(kind, topic, qos)
        self._made.append(lambda: self.node.destroy_publisher(made))
        return made

    def every(self, seconds: float, do: Callable[[], None]) -> None:
        """Do something again and again."""
        made = self.node.create_timer(seconds, do, clock=self._steady)
        self._made.append(lambda: self.node.destroy_timer(made))

    def keep(self, ending: Callable[[], Any]) -> None:
        """Have `clear` call something that ends what was made otherwise."""
        self._made.append(ending)

    def clear(self) -> None:
        """End publishers, subscriptions and timers; the node stays."""
        while self._made:
            self._made.pop()()

    def close(self) -> None:
        """End the node. Can be called twice."""
        if self._closed:
            return
        self._closed = True
        if self._thread.is_alive() and threading.current_thread() is not self._thread:
            self._thread.join(2.0)
        self._executor.shutdown(timeout_sec=1.0)
        self.node.destroy_node()
        self._context.try_shutdown()


def said(depth: int = 50) -> Any:
    """Quality of service of what must arrive: reliable, volatile, the last 50 kept."""
    from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=depth,
        reliability=ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.VOLATILE,
    )


def latched() -> Any:
    """Quality of service of what also who comes late must hear, from whoever keeps it for them."""
    from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=1,
        reliability=ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL,
    )


def seen() -> Any:
    """Quality of service of joints as they are read: best effort, the latest alone.

    It fits whoever sends reliably, and who does not.
    """
    from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=1,
        reliability=ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.VOLATILE,
    )
