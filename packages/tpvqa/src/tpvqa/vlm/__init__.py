"""Pictures + questions → answers, behind the `VLM` protocol."""

from tpvqa.vlm.answer import Answer, Reply
from tpvqa.vlm.protocol import VLM, TruthSource

__all__ = ["VLM", "Answer", "Reply", "TruthSource"]
