"""What a robot does not carry out itself, a look, a question or a plan, ends when it is stopped."""

from collections.abc import Callable
from concurrent.futures import Future, wait
from threading import Thread
from typing import TypeVar

from tpvqa.drivers.plugged import called
from tpvqa.errors import HaltedError
from tpvqa.worlds.capabilities import Halting

T = TypeVar("T")
TICK = 0.02
"""Seconds between two looks at whether it is stopped."""


def unless_halted(world: Halting, do: Callable[[], T]) -> T:
    """Do something, and leave it behind where the world is halted meanwhile.

    What was left behind goes on in a thread that nobody waits for: a server may take a minute.

    Args:
        world: Says whether it is halted.
        do: What is to be done.

    Raises:
        HaltedError: It was halted, before or meanwhile.
        PluginError: The world does not say whether it is.
    """
    doing: Future[T] = Future()

    def run() -> None:
        try:
            doing.set_result(do())
        except BaseException as error:  # noqa: BLE001 — raised again by whoever waits
            doing.set_exception(error)

    _see(world)
    Thread(target=run, daemon=True, name="unless halted").start()
    while not wait((doing,), TICK).done:
        _see(world)
    return doing.result()


def _see(world: Halting) -> None:
    why = called(world, "halted", str)
    if why:
        raise HaltedError(why)
