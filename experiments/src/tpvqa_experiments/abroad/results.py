"""What the bench abroad writes: its tables, and the figures beside their targets."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from tpvqa.bench.ledger import REMEDY
from tpvqa.files import write_whole
from tpvqa_experiments.abroad.parts import Part
from tpvqa_experiments.abroad.tables import Rows, lines, markdown
from tpvqa_experiments.abroad.targets import targets
from tpvqa_experiments.belief.markdown import targets_markdown


def write_results(folder: Path, settings: Mapping[str, Any], parts: Mapping[Part, Rows]) -> None:
    """Write `abroad.md` and `targets.md`, and `abroad.json` and `targets.json` for programs.

    Raises:
        WriteError: The folder cannot be written to.
    """
    checks = targets(parts)
    plain = [
        {"part": str(part), **line.flat()} for part, rows in parts.items() for line in lines(rows)
    ]
    _write(folder / "abroad.md", markdown(settings, parts))
    _write(folder / "abroad.json", json.dumps(plain, indent=1) + "\n")
    _write(folder / "targets.md", targets_markdown(checks))
    _write(folder / "targets.json", json.dumps([each.flat() for each in checks], indent=1) + "\n")


def _write(path: Path, text: str) -> None:
    write_whole(path, text.encode(), remedy=REMEDY)
