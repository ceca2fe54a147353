"""Episodes of a robot on a ward, recorded once."""

import shutil
from pathlib import Path

import pytest

from tests.labelling.robot import Truths, record


@pytest.fixture(scope="session")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Truths]:
    """Six episodes of a belief monitor, and what was true."""
    folder = tmp_path_factory.mktemp("ward")
    return folder, record(folder, 6)


@pytest.fixture
def folders(recorded: tuple[Path, Truths], tmp_path: Path) -> list[Path]:
    """Copies of their own."""
    shutil.copytree(recorded[0], tmp_path / "e")
    return sorted((tmp_path / "e").iterdir())


@pytest.fixture
def truths(recorded: tuple[Path, Truths], folders: list[Path]) -> Truths:
    """What was true in the copies."""
    moved = {str(recorded[0] / each.name): str(each) for each in folders}
    return {(moved[name], look, text): true for (name, look, text), true in recorded[1].items()}
