"""Fast Downward as it is installed: the versions whose translator the worker patches."""

from importlib.metadata import requires, version

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name


@pytest.mark.parametrize("package", ["fast-downward.translate", "up-fast-downward"])
def test_the_installed_version_is_one_that_the_worker_was_written_for(package: str) -> None:
    pins = [
        each.specifier
        for each in map(Requirement, requires("tpvqa") or ())
        if canonicalize_name(each.name) == canonicalize_name(package)
    ]
    assert len(pins) == 1, f"{package} is not pinned once in pyproject.toml, but {len(pins)} times."
    installed = version(package)
    assert installed in pins[0], (
        f"{package} {installed} is installed, but tpvqa.pddl.worker patches the translator of "
        f"{package}{pins[0]} alone (its parsing context, its options; it calls its instantiation, "
        "its fact groups and its SAS+ writer). Install a version that fits, or try the tests in "
        "tests/pddl and tests/planning with the new one and widen the pin in pyproject.toml."
    )
