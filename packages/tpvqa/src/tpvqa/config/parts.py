"""What a setting is; and the settings of who answers."""

import re
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, ConfigDict, Field, model_validator

from tpvqa.addresses import checked_address
from tpvqa.errors import shown
from tpvqa.told import ToldModel

DEVICE = re.compile(r"auto|cpu|mps|cuda(:[0-9]{1,2})?")
"""What a device is called."""
QUALITY = re.compile(r"png|100|[1-9][0-9]?")
"""How pictures are sent."""


def setting(
    option: str,
    says: str,
    default: Any = None,
    *,
    file: bool = False,
    text: bool = False,
    **limits: Any,
) -> Any:
    """A field of the configuration.

    Args:
        option: What the command line calls it.
        says: What it is, in one line.
        default: Its value where none is given.
        file: Whether it names a file or a folder.
        text: Whether the command line takes any text for it, as not only numbers count.
        **limits: Of pydantic's `Field`: ge, le, gt.
    """
    told: dict[str, Any] = {"option": option, "file": file, "text": text}
    return Field(default, description=says, json_schema_extra=told, **limits)


def _address(value: str | None) -> str | None:
    return None if value is None else checked_address(value)


def _device(value: str | None) -> str | None:
    if value is None or DEVICE.fullmatch(value):
        return value
    raise ValueError(f"write auto, cpu, cuda, cuda:N or mps, not {shown(value)}")


def _quality(value: str | None) -> str | None:
    if value is None or QUALITY.fullmatch(value):
        return value
    raise ValueError(f"write a quality of JPEG from 1 to 100, or png, not {shown(value)}")


class Part(ToldModel):
    """Some settings that belong together."""

    model_config = ConfigDict(
        extra="forbid",
        frozen=True,
        allow_inf_nan=False,
        populate_by_name=True,
        hide_input_in_errors=True,
    )


class VLMConfig(Part):
    """Who answers."""

    spec: str | None = setting(
        "--vlm",
        "embedded (the default where there are pictures), openai:MODEL, hf:MODEL, or a noise "
        "model: oracle[:ACCURACY[:RHO[:PERSISTENT]]] (the default where there are none), "
        "recorded:MODEL[:HALF][:fresh], flawed:KIND[:…].",
    )
    base_url: Annotated[str | None, AfterValidator(_address)] = setting(
        "--base-url", "openai: address of a server like OpenAI's."
    )
    cache: str | None = setting(
        "--cache",
        "File of recorded answers: what is there is given, the rest is asked and written.",
        file=True,
    )
    record: str | None = setting(
        "--record", "The same, but everything is asked anew and written.", file=True
    )
    replay: str | None = setting(
        "--replay", "The same, but the VLM is not needed: what is not there is refused.", file=True
    )

    device: Annotated[str | None, AfterValidator(_device)] = setting(
        "--device", "hf: auto (a GPU where there is one; the default), cpu, cuda, cuda:N or mps."
    )
    dtype: Literal["auto", "float32", "bfloat16", "float16"] | None = setting(
        "--dtype",
        "hf: auto (float32 on a CPU, else as the model was saved; the default), float32, bfloat16 "
        "or float16.",
    )
    batch: int | None = setting("--batch", "hf: questions at once. Default: 16.", ge=1)
    together: bool = setting(
        "--together",
        "openai: ask all questions of a step in one request, with a JSON schema.",
        False,
    )
    samples: int | None = setting(
        "--samples",
        "openai: so many samples give P(yes) where the server has no logprobs. Default: none are "
        "drawn.",
        ge=1,
        le=64,
    )
    before_after: bool = setting(
        "--before-after",
        "openai: where an effect is asked about, show the picture before the action, too.",
        False,
    )
    picture_size: int | None = setting(
        "--picture-size",
        "openai: pixels of the longest side of a picture as it is sent. Default: 1024.",
        ge=32,
        le=8192,
    )
    picture_quality: Annotated[str | None, AfterValidator(_quality)] = setting(
        "--picture-quality",
        "openai: send pictures as JPEG of this quality (1 to 100), or as png. Default: as they "
        "are, those made smaller as JPEG of 90.",
        text=True,
    )
    prompt: str | None = setting(
        "--prompt", "openai: file of what the server is told; see `tpvqa prompt`.", file=True
    )
    price_prompt: float | None = setting(
        "--price-prompt", "openai: price of a million tokens of prompts.", ge=0
    )
    price_completion: float | None = setting(
        "--price-completion", "openai: price of a million tokens of completions.", ge=0
    )

    @property
    def answers(self) -> tuple[Literal["cache", "record", "replay"], str] | None:
        """How recorded answers are used, and their file; None where they are not."""
        if self.cache is not None:
            return "cache", self.cache
        if self.record is not None:
            return "record", self.record
        return None if self.replay is None else ("replay", self.replay)

    @model_validator(mode="after")
    def _one_use(self) -> Self:
        if sum(each is not None for each in (self.cache, self.record, self.replay)) > 1:
            raise ValueError("give one of --cache, --record and --replay")
        return self

    @property
    def prices(self) -> tuple[float, float] | None:
        """Of a million tokens of prompts, and of completions; None where none is named."""
        if self.price_prompt is None and self.price_completion is None:
            return None
        return self.price_prompt or 0.0, self.price_completion or 0.0
