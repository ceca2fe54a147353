"""The processor of a model, also where no torchvision is installed.

Processors that take videos, too, want torchvision for these, and refuse to be made without. No
video is ever asked about here, so they are put together without that part.
"""

import importlib.util
from typing import Any


def processor_of(base: str, config: Any) -> Any:
    """What turns pictures and text into a model's input.

    Args:
        base: The model's folder, or its name on the hub.
        config: The model's configuration, of transformers.

    Raises:
        Exception: Whatever transformers raises.
    """
    from transformers import PROCESSOR_MAPPING, AutoProcessor

    kind = PROCESSOR_MAPPING.get(type(config), None)
    if (
        kind is None
        or "video_processor" not in kind.get_attributes()
        or importlib.util.find_spec("torchvision") is not None
    ):
        return AutoProcessor.from_pretrained(base, trust_remote_code=False)
    return _put_together(kind, base)


def without_videos(kind: Any) -> Any:
    """A kind of processor that takes `NO_VIDEOS` in the place of its part for videos."""

    def check(self: Any, argument_name: str, argument: Any) -> Any:
        if argument is NO_VIDEOS:
            return type(NO_VIDEOS)
        return kind.check_argument_for_proper_class(self, argument_name, argument)

    return type(kind.__name__, (kind,), {"check_argument_for_proper_class": check})


class _NoVideos(dict[str, Any]):  # as processors are written down as JSON
    model_input_names: tuple[str, ...] = ()

    def __getattr__(self, name: str) -> None:
        """Nothing is set: how many frames, say."""
        if name.startswith("_"):
            raise AttributeError(name)


NO_VIDEOS = _NoVideos()
"""Stands where a processor has a part for videos."""


def _put_together(kind: Any, base: str) -> Any:
    from transformers import AutoImageProcessor, AutoTokenizer

    def part(name: str) -> Any:
        if name == "video_processor":
            return NO_VIDEOS
        auto = AutoTokenizer if name == "tokenizer" else AutoImageProcessor
        return auto.from_pretrained(base, trust_remote_code=False)

    made = without_videos(kind)
    described, _ = made.get_processor_dict(base)
    return made.from_args_and_dict([part(name) for name in made.get_attributes()], described)
