"""Noise models that err as real VLMs did, from their recorded answers."""

from tpvqa.vlm.recorded.vlm import Recorded

__all__ = ["Recorded"]
