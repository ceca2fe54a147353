"""How many threads multiply matrices, while trials decide."""

from threading import Barrier, Thread

import pytest
from threadpoolctl import ThreadpoolController, threadpool_limits

from tpvqa.belief.deciding.one_thread import _linear_algebra, one_thread


def threads() -> list[int]:
    libraries = ThreadpoolController().select(user_api="blas").info()
    return [each["num_threads"] for each in libraries]


def test_one_within_and_as_many_as_before_afterwards() -> None:
    """Also where two overlap, and who came first leaves first."""
    _linear_algebra.cache_clear()  # another test may have loaded a library since it was found out
    with threadpool_limits(2, user_api="blas"):
        before, one = threads(), one_thread(threads)()
        if max(before, default=1) < 2:
            pytest.skip("this numpy multiplies with one thread alone")
        assert one == [1] * len(before)
    both, left = Barrier(2), Barrier(2)
    before = threads()

    def first() -> None:
        one_thread(lambda: both.wait(10))()
        left.wait(10)

    def second() -> None:
        one_thread(lambda: (both.wait(10), left.wait(10)))()

    each = [Thread(target=first), Thread(target=second)]
    for thread in each:
        thread.start()
    for thread in each:
        thread.join(20)
    assert threads() == before
