"""The visual question answering network that the package carries."""

from tpvqa_household.embedded.vlm import EmbeddedVLM

__all__ = ["EmbeddedVLM"]
