"""Pictures to score a VLM on, and what is true in them."""

from collections.abc import Iterator
from io import BytesIO
from pathlib import Path

from tpvqa.errors import TpvqaError
from tpvqa.observation import Frame, Observation
from tpvqa_household.training.picture_cases import GROUPS
from tpvqa_household.training.scoring import Case


def rendered(folder: Path, seeds: range) -> Iterator[Case]:
    """Pictures that `render` made, of both splits.

    Args:
        folder: Where they lie.
        seeds: Which parts.
    """
    from PIL import Image

    from tpvqa_household.training import shards
    from tpvqa_household.training.data import in_words

    for split, group in (("train", GROUPS["known"]), ("held_out", GROUPS["held_out"])):
        for path in shards.finished(folder, split):
            if int(path.stem.rsplit("-", 1)[1]) not in seeds:
                continue
            shard = shards.read(path)
            table = in_words(shard)
            for i, pixels in enumerate(shard.pixels):
                buffer = BytesIO()
                Image.fromarray(pixels).save(buffer, "PNG")
                frame = Frame(f"{path.stem}-{i}", "front", buffer.getvalue(), "image/png")
                pairs = zip(table.true[i].tolist(), table.visible[i].tolist(), strict=True)
                facts = dict(zip(table.atoms, pairs, strict=True))
                yield Case(Observation(i, 0.0, {"front": frame}), facts, group)


def photographs(folder: Path) -> Iterator[Observation]:
    """The pictures of a folder, by name, whatever they show.

    Raises:
        TpvqaError: There are none.
    """
    from tpvqa.vlm.pictures import observe_file

    endings = {".jpg", ".jpeg", ".png", ".webp"}
    files = sorted(p for p in folder.glob("*") if p.suffix.lower() in endings)
    if not files:
        raise TpvqaError(f"{folder} has no pictures (JPEG, PNG or WebP).")
    for file in files:
        yield observe_file(file)
