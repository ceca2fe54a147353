"""Replies in words."""

from collections.abc import Collection

from tpvqa.vlm import Reply


def words(replies: Collection[Reply]) -> str:
    """Some replies in words: "two noes and a yes"."""
    parts = []
    for reply, one, many in ((Reply.NO, "a no", "noes"), (Reply.YES, "a yes", "yeses")):
        count = sum(1 for each in replies if each is reply)
        if count:
            number = _NUMBERS[count] if count < len(_NUMBERS) else str(count)
            parts.append(one if count == 1 else f"{number} {many}")
    return " and ".join(parts)


_NUMBERS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine")
