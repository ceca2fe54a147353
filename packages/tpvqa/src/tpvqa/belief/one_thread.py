"""Products of small matrices by one thread: to hand them out to several takes longer than they do.

On a machine whose cores are busy it takes a hundred times as long, as the threads wait for each
other.
"""

from collections.abc import Callable
from functools import cache, wraps
from typing import ParamSpec, TypeVar

from threadpoolctl import ThreadpoolController

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


@cache
def _linear_algebra() -> ThreadpoolController:
    return ThreadpoolController().select(user_api="blas")


def one_thread(function: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """Let a function multiply matrices with one thread; how many are set for others stays."""

    @wraps(function)
    def limited(*args: Arguments.args, **kwargs: Arguments.kwargs) -> Result:
        with _linear_algebra().limit(limits=1):
            return function(*args, **kwargs)

    return limited
