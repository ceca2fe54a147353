"""Films are written whole or not at all."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tpvqa_robots.film.writing import write_gif, write_mp4

PICTURES = [np.full((64, 128, 3), 10 * number, np.uint8) for number in range(20)]


class Interrupted(list[Any]):
    """Pictures in whose midst somebody presses Ctrl-C."""

    def __iter__(self) -> Iterator[Any]:
        yield from self[:3]
        raise KeyboardInterrupt


def test_a_film_that_was_interrupted_leaves_what_was_there(tmp_path: Path) -> None:
    film = tmp_path / "film.mp4"
    film.write_bytes(b"the one before")
    with pytest.raises(KeyboardInterrupt):
        write_mp4(film, Interrupted(PICTURES), rate=10)
    assert film.read_bytes() == b"the one before"
    assert list(tmp_path.iterdir()) == [film]


def test_both_films_are_there_when_they_are_done(tmp_path: Path) -> None:
    write_mp4(tmp_path / "film.mp4", PICTURES, rate=10)
    write_gif(tmp_path / "film.gif", PICTURES, rate=10)
    assert (tmp_path / "film.mp4").read_bytes()[4:8] == b"ftyp"
    assert (tmp_path / "film.gif").read_bytes()[:6] == b"GIF89a"
    assert {each.name for each in tmp_path.iterdir()} == {"film.mp4", "film.gif"}
