"""Whether there is anything to be seen: a dead camera must not be taken for an empty kitchen.

A VLM that is shown a black picture says no to "is there a plate?", and is sure of it. So pictures
are looked at before any VLM is, and where none of a look shows anything, every answer is *cannot
see*, with the reason as its text.

A picture is looked at as 32 × 32 patches, the mean colour of each. It shows nothing where

- it is empty, or damaged; what is no JPEG, PNG or WebP at all is left to the VLM;
- the patches are all alike: it is black, white, or of one colour, whatever noise a sensor adds;
- bright patches do not lie beside bright ones: the correlation of neighbours is about 0, as in
  noise. In photographs and rendered pictures it is .5 or more, by night, too.
"""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from tpvqa.errors import PictureError
from tpvqa.observation import Frame, Observation
from tpvqa.pictures import in_colour, picture_type
from tpvqa.questions.question import Question
from tpvqa.vlm.answer import CAMERA, Answer, Reply
from tpvqa.vlm.capabilities import is_noise_model, needs_pictures
from tpvqa.vlm.checking import ask_checked
from tpvqa.vlm.protocol import VLM

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

PATCHES = 32
"""Patches along each side."""
ALIKE = 5
"""Levels, of 256, that the brightest and the darkest patch differ by at least in some colour."""
RELATED = 0.3
"""Least correlation of neighbouring patches."""
_BLACK, _WHITE = 48, 208
_known: dict[bytes, str] = {}  # the pictures of a set are seen again and again


def ask_seeing(vlm: VLM, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
    """What a VLM answers; *cannot see* to everything where it would look and nothing is seen.

    Raises:
        AnswerError: The VLM cannot be asked at all.
        PluginError: It broke, or gave what it must not.
    """
    seen, why = seen_by(vlm, observation)
    return cannot_see(questions, why) if why else ask_checked(vlm, seen, questions)


def seen_by(
    vlm: object, observation: Observation, faults: Mapping[str, str] | None = None
) -> tuple[Observation, str]:
    """What a VLM is shown of a look, and why nothing is to be seen where that is so.

    Args:
        vlm: Noise models that do not look are shown everything.
        observation: The look. Of several views, those that show nothing are left out.
        faults: What is already known to be wrong with views.

    Returns:
        The look, and the reason; empty where some view shows something.
    """
    if not observation.frames or (is_noise_model(vlm) and not needs_pictures(vlm)):
        return observation, ""
    found = {
        view: fault
        for view, frame in observation.frames.items()
        if (fault := (faults or {}).get(view) or picture_fault(frame))
    }
    if not found:
        return observation, ""
    left = {view: frame for view, frame in observation.frames.items() if view not in found}
    if left:
        return replace(observation, frames=left), ""
    several = len(found) > 1
    return observation, "; ".join(f"{v}: {why}" if several else why for v, why in found.items())


def cannot_see(questions: Sequence[Question], why: str) -> list[Answer]:
    """The answers where nothing is to be seen."""
    return [Answer(each, Reply.CANNOT_SEE, source=CAMERA, text=why) for each in questions]


def picture_fault(frame: Frame) -> str:
    """Why nothing is to be seen in a picture; empty where something is."""
    key = hashlib.blake2b(frame.data, digest_size=16).digest()
    fault = _known.get(key)
    if fault is None:
        fault = _fault(frame.data)
        if len(_known) >= 10_000:
            _known.clear()
        _known[key] = fault  # not read again: another thread may clear it
    return fault


def _fault(data: bytes) -> str:
    import numpy as np
    from PIL import Image

    if not data:
        return "the picture is empty: it has 0 bytes"
    try:
        picture_type(data)
    except PictureError:
        return ""
    try:
        picture = in_colour(data)
    except PictureError as error:
        return f"the picture {error}"
    width, height = picture.size
    size = min(PATCHES, width), min(PATCHES, height)
    patches = np.asarray(picture.resize(size, Image.Resampling.BOX), np.float64)
    if np.ptp(patches, axis=(0, 1)).max() < ALIKE:
        mean = patches.mean()
        kind = "black" if mean < _BLACK else "white" if mean > _WHITE else "of one colour"
        return f"the picture is {kind} all over"
    grey = patches.mean(-1)
    beside = [(grey[:, 1:], grey[:, :-1]), (grey[1:], grey[:-1])]
    related = [_correlation(a, b) for a, b in beside if a.size]
    if related and max(related) < RELATED:
        return f"the picture is noise: neighbouring parts have a correlation of {max(related):.2f}"
    return ""


def _correlation(one: "NDArray[np.float64]", other: "NDArray[np.float64]") -> float:
    """Of two arrays; 1 where one of them is constant. A regular pattern is no noise either."""
    one, other = one - one.mean(), other - other.mean()
    spread = float((one**2).mean() * (other**2).mean()) ** 0.5
    return abs(float((one * other).mean())) / spread if spread else 1.0
