"""What is kept from trial to trial, in files of today and of before."""

import json
from codecs import BOM_UTF8
from pathlib import Path

import pytest

from tpvqa.belief.answers.trust import GRID
from tpvqa.belief.learning.experience import Experience
from tpvqa.errors import CalibrationError

OLD = {"version": 1, "failure": [3.0, 9.0], "disturbance": [1.0, 2.0], "trials": 4}


def test_of_a_file_of_before_failures_are_kept_and_not_what_answers_were_worth(
    tmp_path: Path,
) -> None:
    (tmp_path / "old.json").write_text(json.dumps({**OLD, "trust": [1.0] * len(GRID)}))
    known = Experience.load(tmp_path / "old.json")
    assert known is not None
    assert (known.failure, known.trials, known.trust) == ((3.0, 9.0), 4, None)
    known.save(tmp_path / "new.json")
    assert Experience.load(tmp_path / "new.json") == known


def test_what_was_learned_of_answers_today_comes_back(tmp_path: Path) -> None:
    known = Experience(
        failure=(3, 9), disturbance=(1, 2), spontaneous=(1, 20), trust=(1.0,) * len(GRID)
    )
    assert known.chances().rates.spontaneous == pytest.approx(1 / 21)
    known.save(tmp_path / "new.json")
    assert Experience.load(tmp_path / "new.json") == known


def test_a_file_of_a_version_to_come_is_refused(tmp_path: Path) -> None:
    (tmp_path / "new.json").write_text(json.dumps({**OLD, "version": 3}))
    with pytest.raises(CalibrationError, match="version"):
        Experience.load(tmp_path / "new.json")


def test_a_byte_order_mark_is_no_fault_and_a_name_given_twice_is(tmp_path: Path) -> None:
    path = tmp_path / "new.json"
    path.write_bytes(BOM_UTF8 + json.dumps(OLD).encode())
    assert Experience.load(path) is not None
    path.write_text(json.dumps(OLD).replace('"trials": 4', '"trials": 4, "trials": 5'))
    with pytest.raises(CalibrationError, match=r"new\.json: 'trials' is given twice.*learn anew"):
        Experience.load(path)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("failure", [1e308, 18]),
        ("disturbance", [1e30, 10.9]),
        ("spontaneous", [True, 19]),
        ("trials", 10**30),
        ("trials", True),
        ("trust", [1e308] * len(GRID)),
    ],
)
def test_more_than_a_robot_can_have_seen_is_refused(
    tmp_path: Path, name: str, value: object
) -> None:
    (tmp_path / "new.json").write_text(json.dumps({**OLD, "version": 2, name: value}))
    with pytest.raises(CalibrationError, match=name):
        Experience.load(tmp_path / "new.json")


def test_of_a_long_life_the_rates_are_kept(tmp_path: Path) -> None:
    """What was counted without end can be written, read and unlearned."""
    known = Experience(failure=(3, 9), disturbance=(1, 2))
    chances = known.chances()
    chances.failure.yes, chances.failure.no = 4e9, 1.2e10
    Experience.of(chances, None, 9).save(tmp_path / "new.json")
    again = Experience.load(tmp_path / "new.json")
    assert again is not None
    assert again.chances().rates.failure == pytest.approx(0.25)
