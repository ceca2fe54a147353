"""Recorded answers: every answer of a VLM in one file, given again instead of asking."""

from tpvqa.vlm.kept.file import AnswerFile
from tpvqa.vlm.kept.making import kept
from tpvqa.vlm.kept.vlm import KeptVLM, Use

__all__ = ["AnswerFile", "KeptVLM", "Use", "kept"]
