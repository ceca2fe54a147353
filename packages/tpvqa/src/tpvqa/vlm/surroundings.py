"""What of a user's environment decides how a server is asked.

Its values may hold a key or a password, so messages tell the names of variables alone.
"""

import os

from tpvqa.errors import AnswerError

_HEADERS = ("OPENAI_ORG_ID", "OPENAI_PROJECT_ID", "OPENAI_CUSTOM_HEADERS")
_PROXIES = ("HTTP_PROXY", "HTTPS_PROXY", "ALL_PROXY", "NO_PROXY")  # in either case
_CERTIFICATES = ("SSL_CERT_FILE", "SSL_CERT_DIR")


def check_headers(key: str) -> None:
    """See that a request can be built of what openai's package puts into its headers.

    Args:
        key: The value of `OPENAI_API_KEY`, without white space around it.

    Raises:
        ValueError: A variable has characters that no header has. The message names it.
    """
    told = {name: [os.environ.get(name, "")] for name in _HEADERS}
    lines = told["OPENAI_CUSTOM_HEADERS"][0].split("\n")
    told["OPENAI_CUSTOM_HEADERS"] = [line.strip().replace("\t", " ") for line in lines]
    for name, values in {"OPENAI_API_KEY": [key], **told}.items():
        if not all(
            each.isascii() and each.isprintable() and each == each.strip() for each in values
        ):
            raise ValueError(
                f"{name} has characters that cannot be sent: letters beyond ASCII, a line break, a "
                "control character, or a space at an end. Set it again."
            )


def why_no_client(error: Exception) -> str:
    """What of proxies and certificates keeps a client from being made, and the remedy.

    Args:
        error: What making it raised. Its text is told only where it cannot hold a proxy's password.
    """
    proxies, certificates = _given(_PROXIES), _given(_CERTIFICATES)
    socks = [name for name in proxies if os.environ[name].lower().startswith("socks")]
    if isinstance(error, OSError):
        why = error.strerror or str(error)
        named = certificates[-1] if certificates else "the system"  # of both the file is read alone
        return f"no certificates can be read from {named} ({why}). Mend or unset it."
    if isinstance(error, ImportError) and socks:
        return (
            f"{', '.join(socks)} names a SOCKS proxy, which needs a package: pip install socksio. "
            "Or unset it."
        )
    if proxies:
        return (
            f"no proxy can be used as the environment names it: {', '.join(proxies)}. Write "
            "http://HOST:PORT, or unset what is wrong."
        )
    return f"{type(error).__name__}: {error}."


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
