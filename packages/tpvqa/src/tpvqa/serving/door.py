"""Who may ask: on this machine whoever is on it, from elsewhere whoever has the token."""

import hmac
import ipaddress
import os
import re
from collections.abc import Mapping
from pathlib import Path
from urllib.parse import urlsplit

from tpvqa.errors import PlacedError, TpvqaError
from tpvqa.serving.refusal import Refusal
from tpvqa.text_files import read_text

TOKEN = "TPVQA_SERVE_TOKEN"
"""The environment variable that holds the token."""
SHORTEST = 16
_MAKE_ONE = "python -c 'import secrets; print(secrets.token_urlsafe())'"


def is_loopback(host: str) -> bool:
    """Whether a host is this machine and cannot be reached from another."""
    if host.lower() == "localhost":
        return True
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False


def token_for(host: str, file: Path | None = None) -> str | None:
    """The token that whoever asks has to give; None where nobody needs one.

    It comes from a file, or else from the environment; never from the command line, which others
    on the machine can read.

    Args:
        host: Where the server is going to listen.
        file: A file with the token alone.

    Raises:
        TpvqaError: There is none and the host is not loopback alone, or it is no token.
    """
    if file is not None:
        token, where = read_text(file, PlacedError, what="token file").strip(), str(file)
    else:
        token, where = os.environ.get(TOKEN, "").strip(), TOKEN
    if not token and file is None:
        if is_loopback(host):
            return None
        raise TpvqaError(
            f"At {host} others can reach the server, so it needs a token. Set the environment "
            f"variable {TOKEN}, or name a file with --token-file; {_MAKE_ONE} makes one."
        )
    if len(token) < SHORTEST or not re.fullmatch(r"[!-~]+", token):
        raise TpvqaError(
            f"{where}: a token has at least {SHORTEST} letters, digits or signs of ASCII and no "
            f"blanks; {_MAKE_ONE} makes one."
        )
    return token


class Door:
    """Lets requests in, or refuses them.

    Without a token the server is on loopback. A page in the browser of somebody on this machine
    reaches it there, too. Under a name of its own it does not, as the server has to be called by a
    name of loopback; and where it calls the server by that, the browser says whose page it is, or
    asks beforehand whether it may send JSON.

    Args:
        token: What has to be given; None for nothing.
    """

    def __init__(self, token: str | None):
        self._token = None if token is None else token.encode()

    def check(self, headers: Mapping[str, str]) -> None:
        """See whether a request may come in.

        Raises:
            Refusal: It may not.
        """
        if self._token is None:
            self.check_host(headers)
            return
        kind, _, given = headers.get("authorization", "").partition(" ")
        right = hmac.compare_digest(given.strip().encode(), self._token)
        if not right or kind.lower() != "bearer":
            raise Refusal(
                401,
                "The token is missing or wrong. Give the server's as the API key (header "
                "Authorization: Bearer …).",
                code="invalid_api_key",
            )

    def check_host(self, headers: Mapping[str, str]) -> None:
        """See whether the server is called by a name that is its own, where that can be told.

        Raises:
            Refusal: It is not, or a page of another site calls it.
        """
        if self._token is not None:
            return
        if not is_loopback(_host(f"//{headers.get('host', '')}")):
            raise Refusal(
                403,
                "This server listens on this machine alone; call it 127.0.0.1 or localhost.",
                code="foreign_host",
            )
        origin = headers.get("origin")
        foreign = origin is not None and not is_loopback(_host(origin))
        if foreign or headers.get("sec-fetch-site") == "cross-site":
            raise Refusal(
                403,
                "This server answers no web page of another site. Give it a token (--token-file) "
                "and the page the same, or ask it from a program.",
                code="foreign_origin",
            )

    def check_kind(self, headers: Mapping[str, str]) -> None:
        """See whether a body is said to be JSON: a page may send anything else without asking.

        Raises:
            Refusal: It is not.
        """
        kind = headers.get("content-type", "").partition(";")[0].strip().lower()
        if self._token is None and kind != "application/json":
            raise Refusal(
                415,
                "The body has to be JSON and to be sent as such, with the header "
                "Content-Type: application/json.",
                code="unsupported_media_type",
            )


def check_coding(headers: Mapping[str, str]) -> None:
    """See that a body is sent as it is: nothing here unpacks it.

    Raises:
        Refusal: It is compressed.
    """
    coding = headers.get("content-encoding", "").strip().lower()
    if coding not in ("", "identity"):
        raise Refusal(
            415,
            f"The body is sent as {coding[:40]!r}; send it as it is, without Content-Encoding.",
            code="unsupported_coding",
        )


def _host(address: str) -> str:
    """The host of an address; empty where it has none."""
    try:
        return urlsplit(address).hostname or ""
    except ValueError:
        return ""
