"""A VLM with its recorded answers: the file opened, and the VLM found in it."""

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType

from tpvqa.errors import CacheError
from tpvqa.plugins import Closing, Kind, class_of, load_spec
from tpvqa.vlm.capabilities import (
    is_deterministic,
    is_noise_model,
    kind_of,
    parameters_of,
)
from tpvqa.vlm.kept.file import AnswerFile
from tpvqa.vlm.kept.vlm import CountingVLM, KeptVLM, Use, keeps_state
from tpvqa.vlm.protocol import VLM

_OPTION = "option "
NOTHING: Mapping[str, str] = MappingProxyType({})


def kept(
    spec: str,
    path: Path | str,
    use: Use,
    *,
    inner: VLM | None,
    options: Mapping[str, str] = NOTHING,
    asked_so: Mapping[str, str] = NOTHING,
    trial: bytes | None = None,
    owned: bool = False,
) -> KeptVLM:
    """A VLM that gives recorded answers, and writes new ones, by how the file is used.

    Args:
        spec: The VLM's specification in full.
        path: The file.
        use: How it is used.
        inner: The VLM; where answers are replayed it is not asked, and need not be there.
        options: Of the user's, that the VLM is given.
        asked_so: What the user says of its parameters; where answers are replayed, those recorded
            with others are not meant.
        trial: Tells the trial that asks from others; None where each asking is for itself.
        owned: Whether the VLM is closed with this, too.

    Raises:
        CacheError: The file cannot be used, or has no answers of this VLM.
        TpvqaError: There is no such VLM.
    """
    try:
        stands_for = class_of(load_spec(Kind.VLM, spec)) if inner is None else kind_of(inner)
        file, model = _opened(spec, path, use, stands_for, inner, options, asked_so)
    except BaseException:
        if owned and isinstance(inner, Closing):
            inner.close()
        raise
    counting = not is_deterministic(stands_for) or keeps_state(inner)
    return (CountingVLM if counting else KeptVLM)(
        file,
        model,
        use=use,
        name=spec if inner is None else inner.name,
        stands_for=stands_for,
        inner=None if use is Use.REPLAY else inner,
        trial=trial,
        owned=owned and use is not Use.REPLAY,
    )


def _opened(
    spec: str,
    path: Path | str,
    use: Use,
    stands_for: type,
    inner: VLM | None,
    options: Mapping[str, str],
    asked_so: Mapping[str, str],
) -> tuple[AnswerFile, int]:
    """The file, and the number of VLM and parameters in it."""
    if is_noise_model(stands_for):
        raise CacheError(
            f"{spec!r} is a noise model: it answers from the truth of a simulated world by its "
            "seed, always the same and for nothing. Its answers are not recorded; leave the "
            "file out"
        )
    file = AnswerFile(path, writing=use is not Use.REPLAY)
    try:
        told = {f"{_OPTION}{name}": value for name, value in options.items()}
        if use is Use.REPLAY or inner is None:
            return file, _recorded(file, spec, told, asked_so)
        return file, file.model(spec, parameters_of(inner) | told)
    except BaseException:
        file.close()
        raise


def _recorded(
    file: AnswerFile, spec: str, options: Mapping[str, str], asked_so: Mapping[str, str]
) -> int:
    """The one VLM of the file that is meant.

    Raises:
        CacheError: There is none, or there are several.
    """
    every = file.models()
    found = [
        (number, parameters)
        for number, name, parameters in every
        if name == spec
        and {k: v for k, v in parameters.items() if k.startswith(_OPTION)} == dict(options)
        and all(parameters.get(name) == value for name, value in asked_so.items())
    ]
    if not found:
        known = ", ".join(dict.fromkeys(name for _, name, _ in every)) or "nobody"
        same = " with these options" if any(name == spec for _, name, _ in every) else ""
        raise CacheError(
            f"{file.path}: there are no recorded answers of {spec!r}{same}, but of: {known}. "
            "Record some with --cache"
        )
    if len(found) > 1:
        sets = "; ".join(
            f"{number}: {', '.join(f'{k} {v}' for k, v in told.items()) or 'none'}"
            for number, told in found
        )
        raise CacheError(
            f"{file.path}: answers of {spec!r} were recorded with different parameters ({sets}). "
            f"Keep one: `tpvqa cache prune {file.path} --model NUMBER` removes another"
        )
    return found[0][0]
