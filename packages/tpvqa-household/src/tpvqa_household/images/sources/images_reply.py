"""The wire: what an images server's reply says."""

import base64
import binascii
import json
from collections.abc import Mapping
from dataclasses import dataclass

from pydantic import Field, ValidationError

from tpvqa.told import ToldModel
from tpvqa_household.images.sources.picture_file import read_picture


@dataclass(frozen=True, slots=True)
class Elsewhere:
    """The picture lies at an address, for some time."""

    url: str


class _Image(ToldModel):
    b64_json: str | None = None
    url: str | None = None


class _Reply(ToldModel):
    data: list[_Image] = Field(min_length=1)


def read_reply(body: bytes) -> bytes | Elsewhere:
    """The picture of a reply, or where it lies.

    Raises:
        ValueError: The reply cannot be read or holds no picture; says why.
    """
    try:
        image = _Reply.model_validate_json(body).data[0]
    except ValidationError:
        raise ValueError(f"garbled reply: {body[:200].decode('utf-8', 'replace')}") from None
    if image.b64_json:
        try:
            data = base64.b64decode(image.b64_json, validate=True)
        except binascii.Error as error:
            raise ValueError(f"garbled base64 ({error})") from error
        return whole(data)
    if image.url:
        if not image.url.startswith(("http://", "https://")):
            raise ValueError(f"the picture's address {image.url[:100]!r} is none")
        return Elsewhere(image.url)
    raise ValueError("the reply holds no picture")


def whole(data: bytes) -> bytes:
    """The data, if they are a picture.

    Raises:
        ValueError: They are none.
    """
    read_picture(data)
    return data


def complaint(body: object) -> Mapping[str, str]:
    """The parts of an error's body that say what is wrong: message, code, type."""
    if isinstance(body, (str, bytes)):
        try:
            body = json.loads(body)
        except (ValueError, RecursionError):
            return {"message": str(body)[:300]}
    inner = body.get("error", body) if isinstance(body, Mapping) else body
    if not isinstance(inner, Mapping):
        return {} if inner is None else {"message": str(inner)[:300]}
    parts = {key: inner.get(key) for key in ("message", "code", "type", "detail")}
    return {key: str(value)[:300] for key, value in parts.items() if value}
