"""What a request is refused with, in the shape of OpenAI's errors."""

from typing import Any


class Refusal(Exception):  # noqa: N818 — an answer to a request, not an error of the program
    """A request is refused.

    Args:
        status: The HTTP status.
        message: What is wrong, and what to do about it.
        param: The parameter that is wrong, where it is one.
        code: A name for what is wrong, where OpenAI or this endpoint has one.
        retry_after: Seconds after which asking again may help.
    """

    def __init__(
        self,
        status: int,
        message: str,
        *,
        param: str | None = None,
        code: str | None = None,
        retry_after: int | None = None,
    ):
        super().__init__(message)
        self.status, self.message, self.param, self.code = status, message, param, code
        self.retry_after = retry_after

    @property
    def body(self) -> dict[str, Any]:
        """The reply's body."""
        kinds = {401: "authentication_error", 403: "permission_error", 429: "rate_limit_error"}
        kind = "server_error" if self.status >= 500 else "invalid_request_error"
        error = {
            "message": self.message,
            "type": kinds.get(self.status, kind),
            "param": self.param,
            "code": self.code,
        }
        return {"error": error}

    @property
    def headers(self) -> dict[str, str]:
        """The reply's headers, beside the usual ones."""
        headers = {}
        if self.retry_after is not None:
            headers["Retry-After"] = str(self.retry_after)
        if self.status == 401:
            headers["WWW-Authenticate"] = "Bearer"
        return headers
