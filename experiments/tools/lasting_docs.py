"""Put what the belief bench has measured of errors that last into the documentation.

`python experiments/tools/lasting_docs.py FOLDER`, with the folder that `tpvqa bench belief --parts
lasting` has written. Between `<!-- lasting -->` and `<!-- end -->`, the targets of
`docs/belief-measured.md` are made again; `docs/lasting-results.md` is a copy of all tables.
"""

import argparse
import re
import shutil
import sys
from pathlib import Path

from tpvqa_experiments.belief.tables import LASTING

DOCS = Path(__file__).parents[2] / "docs"
RESULTS = "lasting-results.md"
TARGETS = re.compile(r"## Targets\n\n(.*?)\n(?=## |\Z)", re.DOTALL)
BETWEEN = re.compile(r"(<!-- lasting -->\n).*?(<!-- end -->)", re.DOTALL)


def main() -> None:
    """Make the table again and copy the rest."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--docs", type=Path, default=DOCS)
    given = parser.parse_args()
    tables, page = given.folder / LASTING, given.docs / "belief-measured.md"
    if not tables.is_file():
        sys.exit(f"{given.folder} holds no {LASTING}. Run `tpvqa bench belief --parts lasting`")
    targets = TARGETS.search(tables.read_text(encoding="utf-8"))
    if targets is None:
        sys.exit(f"{tables} has no targets: the belief monitor was not run there")
    text = page.read_text(encoding="utf-8")
    if not BETWEEN.search(text):
        sys.exit(f"{page}: there is no <!-- lasting --> … <!-- end -->")
    made = f"\n{targets[1]}\nEvery cell and every rival: [{RESULTS}]({RESULTS}).\n\n"
    page.write_text(BETWEEN.sub(lambda match: f"{match[1]}{made}{match[2]}", text), "utf-8")
    shutil.copy(tables, given.docs / RESULTS)


if __name__ == "__main__":
    main()
