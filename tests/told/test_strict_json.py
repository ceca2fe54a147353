"""JSON in which nothing can be taken in two ways."""

import time

import pytest

from tpvqa.told import check_json, check_names


@pytest.mark.parametrize("check", [check_json, check_names])
def test_a_name_given_twice_is_found_among_many_at_once(check: object) -> None:
    assert callable(check)
    names = [f'"{number}":0' for number in range(80_000)]
    start = time.monotonic()
    check(("{" + ",".join(names) + "}").encode())
    with pytest.raises(ValueError, match="'79999' is given twice"):
        check(("{" + ",".join([*names, names[-1]]) + "}").encode())
    assert time.monotonic() - start < 10


@pytest.mark.parametrize("text", ['{"a": {"b": 1, "b": 2}}', '[{"a": 1, "\\u0061": 1}]', "{", ""])
def test_doubled_names_are_found_wherever_they_stand(text: str) -> None:
    with pytest.raises(ValueError):  # noqa: PT011
        check_names(text)


def test_numbers_are_checked_where_they_are_counted_with() -> None:
    strange = '{"a": [NaN, -Infinity, 1e999, %s]}' % ("9" * 5_000)
    check_names(strange)
    with pytest.raises(ValueError, match="no number"):
        check_json(strange.encode())
