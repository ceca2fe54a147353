"""Where a model runs, and in which numbers."""

from typing import TYPE_CHECKING, Any

from tpvqa.errors import AnswerError

if TYPE_CHECKING:
    import torch

AUTO = "auto"


def device_of(named: str) -> "torch.device":
    """The device of a name: cpu, cuda, cuda:1, mps; `auto` takes the first GPU, if there is one.

    Raises:
        AnswerError: There is no such device here.
    """
    import torch

    if named == AUTO:
        if torch.cuda.is_available():
            return torch.device("cuda")
        return torch.device("mps" if torch.backends.mps.is_available() else "cpu")
    kind, _, number = named.partition(":")
    if kind == "mps" and not torch.backends.mps.is_available():
        raise AnswerError(f"--device {named}: there is no Apple GPU here. Take --device cpu.")
    if kind == "cuda":
        if not torch.cuda.is_available():
            raise AnswerError(
                f"--device {named}: this torch ({torch.__version__}) sees no CUDA GPU. Take "
                "--device cpu, or install a driver and a build of torch for it."
            )
        if int(number or 0) >= torch.cuda.device_count():
            raise AnswerError(
                f"--device {named}: the GPUs here have the numbers 0 to "
                f"{torch.cuda.device_count() - 1}."
            )
    return torch.device(named)


def dtype_of(named: str, device: "torch.device") -> Any:
    """The numbers of a name, as `from_pretrained` takes them.

    `auto` is float32 on a CPU, which computes half precision slowly, and elsewhere what the
    checkpoint was saved in.
    """
    import torch

    if named == AUTO:
        return torch.float32 if device.type == "cpu" else AUTO
    return getattr(torch, named)
