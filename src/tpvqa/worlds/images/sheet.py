"""A contact sheet of a set of pictures: one self-contained HTML page."""

import base64
from collections.abc import Iterable, Sequence
from html import escape

from tpvqa.worlds.images.manifest import OUTCOMES, Picture, PictureSet

STYLE = """
body { font: 14px/1.4 system-ui, sans-serif; margin: 1.5rem; color: #222; }
h2 { margin: 2rem 0 .3rem; font-size: 1.05rem; } h3 { margin: .8rem 0 .3rem; font-weight: 600; }
.row { display: flex; flex-wrap: wrap; gap: 6px; }
figure { margin: 0; width: 168px; } img { width: 168px; height: 168px; display: block; }
figcaption { font-size: 11px; color: #555; } details { max-width: 168px; overflow: hidden; }
.failure { color: #a30; } .success { color: #063; }
"""


def contact_sheet(pictures: PictureSet) -> str:
    """All pictures by task, action and outcome, then by visible state, as an HTML page."""
    sections = []
    actions = {
        (shows.task, shows.action): None
        for picture in pictures.manifest.pictures
        for shows in picture.shows
    }
    for task, action in sorted(actions):
        sections.append(f"<h2>{escape(task)}: {escape(action)}</h2>")
        for outcome in OUTCOMES:
            found = [
                picture
                for picture in pictures.manifest.pictures
                if any(
                    (s.task, s.action, s.outcome) == (task, action, outcome) for s in picture.shows
                )
            ]
            sections.append(f'<h3 class="{outcome}">{outcome}: {len(found)} pictures</h3>')
            sections.append(_row(pictures, found))
    sections.append("<h2>Every visible state</h2>")
    for visible in sorted({picture.visible for picture in pictures.manifest.pictures}):
        found = [p for p in pictures.manifest.pictures if p.visible == visible]
        sections.append(f"<h3>{escape(visible)}: {len(found)} pictures</h3>")
        sections.append(_row(pictures, found))
    data = _images(pictures)
    return (
        "<!doctype html><html lang='en'><meta charset='utf-8'>"
        f"<title>Pictures of the kitchen</title><style>{STYLE}</style>"
        f"<h1>{len(pictures.manifest.pictures)} pictures</h1>"
        f"{''.join(sections)}{data}</html>"
    )


def _row(pictures: PictureSet, found: Iterable[Picture]) -> str:
    return f'<div class="row">{"".join(map(_figure, found))}</div>'


def _figure(picture: Picture) -> str:
    true = {text for text in picture.state if text in picture.seen}
    false = picture.seen - true
    hidden = set(picture.state) - picture.seen
    facts = "".join(
        f"<b>{name}</b><br>{escape(' '.join(sorted(texts)))}<br>"
        for name, texts in (("true", true), ("false", false), ("true, not seen", hidden))
    )
    return (
        f'<figure><img data-file="{escape(picture.file)}" alt="{escape(picture.visible)}">'
        f"<figcaption>{escape(picture.file)} · {picture.renderer} · {picture.meshes}"
        f"<details><summary>facts</summary>{facts}</details></figcaption></figure>"
    )


def _images(pictures: PictureSet) -> str:
    # Each picture stands in the page once, however often it is shown.
    entries = ",".join(
        f'"{picture.file}":"{base64.b64encode(pictures.read(picture)).decode()}"'
        for picture in pictures.manifest.pictures
    )
    return (
        f"<script>const data={{{entries}}};"
        "for (const image of document.querySelectorAll('img'))"
        " image.src='data:image/jpeg;base64,'+data[image.dataset.file];</script>"
    )


def table(pictures: PictureSet, chosen: Sequence[Picture], *, columns: int = 8) -> bytes:
    """Some pictures side by side, as one PNG."""
    from io import BytesIO

    from PIL import Image

    rows = -(-len(chosen) // columns)
    side = max(picture.width for picture in chosen)
    sheet = Image.new("RGB", (columns * side, rows * side), "white")
    for number, picture in enumerate(chosen):
        with Image.open(BytesIO(pictures.read(picture))) as image:
            sheet.paste(image, (number % columns * side, number // columns * side))
    buffer = BytesIO()
    sheet.save(buffer, "PNG")
    return buffer.getvalue()
