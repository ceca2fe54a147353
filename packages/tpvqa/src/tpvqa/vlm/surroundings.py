"""What of a user's environment decides how a server is asked.

Its values may hold a key or a password, so messages tell the names of variables alone.
"""

import os

from tpvqa.errors import AnswerError

_HEADERS = ("OPENAI_ORG_ID", "OPENAI_PROJECT_ID", "OPENAI_CUSTOM_HEADERS")
_PROXIES = ("HTTP_PROXY", "HTTPS_PROXY", "ALL_PROXY", "NO_PROXY")  # in either case


def innermost(error: BaseException) -> BaseException:
    """What a group of errors comes from: the first of them, before others an error of ours."""
    while isinstance(error, BaseExceptionGroup):
        error = (error.subgroup(AnswerError) or error).exceptions[0]
    return error


def what_to_look_at() -> str:
    """A sentence that names the variables that are set, where there are any."""
    names = ", ".join(_given((*_HEADERS, *_PROXIES)))
    return f" The environment decides how it is asked: look at {names}." if names else ""


def _given(names: tuple[str, ...]) -> list[str]:
    """Those that are set, as they are written."""
    return sorted(name for name, value in os.environ.items() if value and name.upper() in names)
