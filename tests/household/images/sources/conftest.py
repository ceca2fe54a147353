"""Labels of a task, photos in folders, and prompts."""

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.household.images.sources.images_server import picture
from tpvqa_household.images.reachable import Reachable
from tpvqa_household.images.sources.labels import Label, labels


@pytest.fixture(scope="session")
def dish_labels(clean_dishes: Reachable) -> list[Label]:
    return labels([clean_dishes])


@pytest.fixture
def add_photo(tmp_path: Path) -> Callable[[str, int], Path]:
    """Put a photo into a folder of photos; another number is another photo."""

    def add(name: str, number: int) -> Path:
        path = tmp_path / "photos" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(picture(number, side=96))
        return path

    return add
