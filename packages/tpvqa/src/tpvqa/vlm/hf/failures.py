"""What goes wrong in torch and transformers, in words that help."""

from collections.abc import Iterator
from contextlib import contextmanager

from tpvqa.errors import AnswerError

_REMEDY = (
    "Take a smaller model, --dtype bfloat16, fewer questions at once (--batch 1), or another "
    "--device"
)


@contextmanager
def told_plainly(name: str, doing: str) -> Iterator[None]:
    """Turn what a library raises into one sentence.

    Args:
        name: Of the VLM.
        doing: What it was about, e.g. "loaded".

    Raises:
        AnswerError: Something was raised within.
    """
    try:
        yield
    except AnswerError:
        raise
    except Exception as error:  # models raise of every kind
        if out_of_memory(error):
            raise AnswerError(f"{name} cannot be {doing}: out of memory. {_REMEDY}.") from None
        said = " ".join(str(error).split())[:500]
        raise AnswerError(
            f"{name} cannot be {doing}: {type(error).__name__}{said and f': {said}'}"
        ) from error


def out_of_memory(error: BaseException) -> bool:
    """Whether that is what an error says."""
    import torch

    if isinstance(error, (MemoryError, torch.OutOfMemoryError)):
        return True
    said = str(error).lower()
    return isinstance(error, RuntimeError) and any(
        words in said for words in ("out of memory", "can't allocate memory", "not enough memory")
    )
