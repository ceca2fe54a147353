"""Addresses of servers, as a user may write them: they are logged, so they hold no secrets."""

from urllib.parse import urlsplit


def checked_address(address: str) -> str:
    """An address of a server that may be logged and printed.

    Raises:
        ValueError: It is none, or may hold a secret. The message does not repeat it.
    """
    try:
        parts = urlsplit(address)
        host, _ = parts.hostname, parts.port
    except ValueError:
        host, parts = None, urlsplit("")
    if "@" in address or parts.query or parts.fragment:
        raise ValueError(
            "the address of a server holds a user name, a password or a query, which would be "
            "logged. Leave it out, and give the key by the environment variable OPENAI_API_KEY"
        )
    if parts.scheme.lower() not in ("http", "https") or not host or not address.isprintable():
        raise ValueError(
            "this is no address of a server. Write it with http:// or https:// and its path, e.g. "
            "http://localhost:8000/v1"
        )
    return address
