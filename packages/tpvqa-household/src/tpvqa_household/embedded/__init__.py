"""The visual question answering network that the package carries."""

from tpvqa.vlm.embedded.vlm import EmbeddedVLM

__all__ = ["EmbeddedVLM"]
