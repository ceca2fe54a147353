"""While a world file cannot be read, nothing is said to be missing in it."""

from pathlib import Path

import pytest

from tests.checking.test_check import Files

EXTRA = """
  (:action exorcise
    :parameters (?p - part ?t - tray)
    :precondition (and (cursed ?t) (held ?p))
    :effect (pressed ?p)))
"""


@pytest.fixture
def files(tmp_path: Path) -> Files:
    """A domain that nothing is found in, by what its world file says of a sensor and a curse."""
    files = Files(tmp_path)
    files.change("domain.pddl", "    :effect (pressed ?p)))\n", "    :effect (pressed ?p))" + EXTRA)
    files.change("domain.pddl", "(free)\n", "(free) (cursed ?t - tray)\n")
    files.change("questions.yaml", "never_asked:", 'never_asked:\n  - fact: "(pressed ?p)"')
    files.change("questions.yaml", "actions:", "actions:\n  exorcise: {say: exorcise it}")
    files.change("world.yaml", '", (free)]', '", "(cursed spare_tray)"]')
    return files.change("world.yaml", "(free)\n", '(free)\n  - fact: "(pressed ?p)"\n')


@pytest.mark.parametrize("fault", ["(helt ?p)", '"(held ?p"'])
def test_what_may_stand_in_a_broken_world_file_is_not_proposed(files: Files, fault: str) -> None:
    assert not files.found()
    (found,) = files.change("world.yaml", "(held ?p)", fault).found()
    assert found.kind == "world"
