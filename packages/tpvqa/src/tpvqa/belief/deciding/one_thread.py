"""Products of small matrices by one thread: to hand them out to several takes longer than they do.

On a machine whose cores are busy it takes a hundred times as long, as the threads wait for each
other.
"""

from collections.abc import Callable
from functools import cache, wraps
from threading import Lock
from typing import ParamSpec, TypeVar

from threadpoolctl import ThreadpoolController

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")

_WITHIN = Lock()


@cache
def _linear_algebra() -> ThreadpoolController:
    return ThreadpoolController().select(user_api="blas")


def one_thread(function: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """Let a function multiply matrices with one thread; afterwards there are as many as before.

    The limit is the whole process's. While one thread is within, others set none of their own:
    who came second would take what the first has set for what was before.
    """

    @wraps(function)
    def limited(*args: Arguments.args, **kwargs: Arguments.kwargs) -> Result:
        if not _WITHIN.acquire(blocking=False):
            return function(*args, **kwargs)
        try:
            with _linear_algebra().limit(limits=1):
                return function(*args, **kwargs)
        finally:
            _WITHIN.release()

    return limited
