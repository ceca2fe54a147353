"""Managed nodes: what a node does at each stage of its life, as ROS 2's lifecycle has them."""

import sys
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from tpvqa.errors import TpvqaError


@dataclass(frozen=True, slots=True)
class Stages:
    """What is done when a managed node passes from one stage to the next.

    Attributes:
        configure: unconfigured → inactive: topics, actions and services are made.
        activate: inactive → active: it does what it is asked.
        deactivate: active → inactive: what runs is stopped, nothing new begins.
        cleanup: inactive → unconfigured: topics, actions and services are gone.
        shutdown: It ends, from whatever stage; what runs is stopped first.
    """

    configure: Callable[[], None]
    activate: Callable[[], None]
    deactivate: Callable[[], None]
    cleanup: Callable[[], None]
    shutdown: Callable[[], None]


def managed_node(stages: Stages) -> Callable[..., Any]:
    """The class of a node with these stages."""
    from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn

    def tried(*steps: Callable[[], None]) -> Any:
        try:
            for step in steps:
                step()
        except TpvqaError as error:
            print(error, file=sys.stderr)
            return TransitionCallbackReturn.FAILURE
        except Exception as error:  # noqa: BLE001 — rclpy would swallow it
            traceback.print_exception(error, file=sys.stderr)
            return TransitionCallbackReturn.FAILURE
        return TransitionCallbackReturn.SUCCESS

    class ManagedNode(LifecycleNode):  # type: ignore[misc]
        def on_configure(self, _: Any) -> Any:
            return tried(stages.configure)

        def on_activate(self, _: Any) -> Any:
            return tried(stages.activate)

        def on_deactivate(self, _: Any) -> Any:
            return tried(stages.deactivate)

        def on_cleanup(self, _: Any) -> Any:
            return tried(stages.cleanup)

        def on_shutdown(self, state: Any) -> Any:
            first = (stages.deactivate,) if state.label == "active" else ()
            return tried(*first, stages.shutdown)

    return ManagedNode


def begin(node: Any) -> None:
    """Take a managed node to its active stage, where nobody else manages it."""
    node.trigger_configure()
    node.trigger_activate()
