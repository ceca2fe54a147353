"""A contact sheet of a set of pictures: one self-contained HTML page."""

import base64
import json
from collections import Counter
from collections.abc import Iterable, Sequence
from html import escape

from tpvqa_household.images.manifest import ORIGINS, OUTCOMES, Picture, PictureSet, Shows

HEAD = "<!doctype html><html lang='en'><meta charset='utf-8'><title>Pictures of the kitchen</title>"
"""How every such page begins."""
STYLE = """
body { font: 14px/1.4 system-ui, sans-serif; margin: 1.5rem; color: #222; }
h2 { margin: 2rem 0 .3rem; font-size: 1.05rem; } h3 { margin: .8rem 0 .3rem; font-weight: 600; }
.row { display: flex; flex-wrap: wrap; gap: 6px; }
figure { margin: 0; width: 168px; } img { width: 168px; height: 168px; display: block; }
figcaption { font-size: 11px; color: #555; overflow-wrap: anywhere; }
summary { cursor: pointer; }
.failure { color: #a30; } .success { color: #063; }
.frame { position: relative; }
.badge { position: absolute; left: 4px; top: 4px; padding: 0 5px; border-radius: 3px;
  color: #fff; font-size: 11px; background: #666; }
.badge.photo { background: #06763f; } .badge.variation { background: #1d55b5; }
.badge.generated { background: #7a2d9c; }
table { border-collapse: collapse; }
td, th { padding: 1px 10px 1px 0; text-align: left; }
"""


def contact_sheet(pictures: PictureSet) -> str:
    """All pictures by task, action and outcome, then by visible state, as an HTML page."""
    manifest = pictures.manifest
    sections, lines = [], []
    actions = {(shows.task, shows.action) for p in manifest.pictures for shows in p.shows}
    for number, (task, action) in enumerate(sorted(actions)):
        sections.append(f'<h2 id="a{number}">{escape(task)}: {escape(action)}</h2>')
        for outcome in OUTCOMES:
            wanted = Shows(task=task, action=action, outcome=outcome)
            got_for = [p for p in manifest.pictures if p.origin.got_for == wanted]
            others = [p for p in manifest.pictures if wanted in p.shows and p not in got_for]
            heading = f"{outcome}: {len(got_for) + len(others)} pictures"
            if got_for:
                heading = f"{outcome}: {len(got_for)} pictures got for it, {_counted(got_for)}"
            sections.append(f'<h3 class="{outcome}">{heading}</h3>')
            sections.append(_row(pictures, got_for or others))
            if got_for and others:
                sections.append(
                    f"<details><summary>{len(others)} of other actions show it too</summary>"
                    f"{_row(pictures, others)}</details>"
                )
            lines.append(
                f'<tr><td>{escape(task)}</td><td><a href="#a{number}">{escape(action)}</a></td>'
                f'<td class="{outcome}">{outcome}</td>'
                f"<td>{_counted(got_for or others)}</td></tr>"
            )
    sections.append("<h2>Every visible state</h2>")
    for visible in sorted({picture.visible for picture in manifest.pictures}):
        found = [p for p in manifest.pictures if p.visible == visible]
        sections.append(f"<h3>{escape(visible)}: {len(found)} pictures</h3>")
        sections.append(_row(pictures, found))
    return (
        f"{HEAD}<style>{STYLE}</style>"
        f"<h1>{len(manifest.pictures)} pictures: {_counted(manifest.pictures)}</h1>"
        f"<table>{''.join(lines)}</table>"
        f"{''.join(sections)}{_images(pictures)}</html>"
    )


def _counted(found: Iterable[Picture]) -> str:
    counts = Counter(picture.origin.kind for picture in found)
    return ", ".join(f"{counts[kind]} {kind}" for kind in ORIGINS if counts[kind])


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
    origin = picture.origin
    made = [picture.renderer or "", origin.generator, picture.meshes]
    came = [
        ("from", origin.source if origin.source != picture.file else ""),
        ("prompt", origin.prompt),
        ("seed", "" if origin.seed is None else str(origin.seed)),
        ("cost", "" if not origin.cost else f"${origin.cost:g}"),
    ]
    facts += "".join(f"<b>{name}</b> {escape(said)}<br>" for name, said in came if said)
    return (
        f'<figure><div class="frame"><img data-file="{escape(picture.file)}" '
        f'alt="{escape(picture.visible)}">'
        f'<span class="badge {origin.kind}">{origin.kind}</span></div>'
        f"<figcaption>{escape(picture.file)} · {escape(' · '.join(filter(None, made)))}"
        f"<details><summary>facts and origin</summary>{facts}</details></figcaption></figure>"
    )


def _images(pictures: PictureSet) -> str:
    # Each picture stands in the page once, however often it is shown.
    entries = ",".join(
        f'{_in_script(picture.file)}:"{base64.b64encode(pictures.read(picture)).decode()}"'
        for picture in pictures.manifest.pictures
    )
    return (
        f"<script>const data={{{entries}}};"
        "for (const image of document.querySelectorAll('img'))"
        " image.src='data:image/jpeg;base64,'+data[image.dataset.file];</script>"
    )


def _in_script(text: str) -> str:
    return json.dumps(text).replace("<", "\\u003c")


def table(pictures: PictureSet, chosen: Sequence[Picture], *, columns: int = 8) -> bytes:
    """Some pictures side by side, as one PNG."""
    from io import BytesIO

    from PIL import Image

    from tpvqa.pictures import decoded

    rows = -(-len(chosen) // columns)
    side = max(picture.width for picture in chosen)
    sheet = Image.new("RGB", (columns * side, rows * side), "white")
    for number, picture in enumerate(chosen):
        image = decoded(pictures.read(picture))
        sheet.paste(image, (number % columns * side, number // columns * side))
    buffer = BytesIO()
    sheet.save(buffer, "PNG")
    return buffer.getvalue()
