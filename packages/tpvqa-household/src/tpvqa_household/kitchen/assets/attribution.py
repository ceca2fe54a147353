"""Who made the scanned things, generated from the pack's index.

    python -m tpvqa_household.kitchen.assets.attribution

writes the texts that stand in NOTICE and docs/assets.md; a test compares them.
"""

from collections.abc import Iterable
from typing import Any

from tpvqa_household.kitchen.assets import pack

LICENCES = {
    "CC0-1.0": "https://creativecommons.org/publicdomain/zero/1.0/",
    "CC-BY-3.0": "https://creativecommons.org/licenses/by/3.0/",
    "CC-BY-3.0-US": "https://creativecommons.org/licenses/by/3.0/us/",
}
HOLDERS = {
    "Kator Legaz": "Andrew Kator & Jennifer Legaz",
    "Scopia": "Scopia Visual Interfaces Systems, s.l., and Emmanuel Puybaret / eTeks",
}
INTRODUCTION = """\
The kitchen's scanned things (tpvqa_household/kitchen/assets/scanned.zip) were made by others
and come from the furniture packs of Sweet Home 3D (https://www.sweethome3d.com). They were
changed: turned upright, scaled to metres, split by material, simplified, their pictures made
smaller. All other shapes and pictures are this project's own."""


def creator(entry: dict[str, Any]) -> str:
    """Whom to credit for a thing, in full."""
    name = str(entry["creator"])
    return HOLDERS.get(name, name)


def notice() -> str:
    """The paragraph for NOTICE: licence by licence, creator by creator, what they made."""
    lines = [INTRODUCTION]
    for licence, address in LICENCES.items():
        found = [e for e in pack.index() if e["licence"] == licence]
        if not found:
            continue
        lines += ["", f"{licence} ({address}):"]
        for name in sorted({creator(e) for e in found}):
            things = ", ".join(sorted(_source(e) for e in found if creator(e) == name))
            lines.append(f"- {name}: {things}")
    return "\n".join(lines) + "\n"


def table() -> str:
    """The table for docs/assets.md, one row for each scanned thing."""
    rows = [
        "| thing | kind | split | creator | pack: model | licence |",
        "|---|---|---|---|---|---|",
    ]
    rows += [
        f"| {e['name']} | {e['kind']} | {'held out' if e['held_out'] else 'train'} |"
        f" {creator(e)} | {e['pack']}: {e['model']} | [{e['licence']}]({LICENCES[e['licence']]}) |"
        for e in sorted(pack.index(), key=lambda e: (str(e["kind"]), str(e["name"])))
    ]
    return "\n".join(rows) + "\n"


def counts(families: Iterable[Any]) -> str:
    """The table of kinds: how many families are procedural and scanned, in each split."""
    scanned = {str(e["name"]) for e in pack.index()}
    by_kind: dict[str, list[int]] = {}
    for family in families:
        row = by_kind.setdefault(family.kind, [0, 0, 0, 0])
        is_scanned = family.name.removesuffix("-half") in scanned
        row[2 * family.held_out + is_scanned] += 1
    lines = [
        "| kind | train: procedural | train: scanned | held out: procedural | held out: scanned |",
        "|---|---|---|---|---|",
    ]
    lines += [f"| {kind} | " + " | ".join(map(str, row)) + " |" for kind, row in by_kind.items()]
    return "\n".join(lines) + "\n"


def _source(entry: dict[str, Any]) -> str:
    return f"{entry['name']} (from {entry['pack']}/{entry['model']})"


def main() -> None:
    """Print all three."""
    from tpvqa_household.kitchen.assets.families import FAMILIES

    print(notice(), table(), counts(FAMILIES), sep="\n")


if __name__ == "__main__":
    main()
