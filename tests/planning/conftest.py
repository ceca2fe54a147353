"""A planner for the tests of planning."""

from collections.abc import Iterator

import pytest

from tpvqa.planning import Planner
from tpvqa.planning.fast_downward import FastDownward


@pytest.fixture(scope="module")
def planner() -> Iterator[Planner]:
    planner = FastDownward()
    yield planner
    planner.close()
