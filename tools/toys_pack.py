"""The scans on the toys' table, out of the household's zip: `python tools/toys_pack.py`.

From the folder of a clone. The robots' package does not need the household's.
"""

import json
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

from tpvqa_robots.grasps.training.catalogue import PACK
from tpvqa_robots.toys.scans import FILE, SCANS


def main() -> None:
    """The command."""
    wanted = {scan.name for scan in SCANS.values()}
    with ZipFile(PACK) as all_of_them, ZipFile(FILE, "w", ZIP_DEFLATED, compresslevel=9) as pack:
        index = [e for e in json.loads(all_of_them.read("index.json")) if e["name"] in wanted]
        files = [part[key] for e in index for part in e["parts"] for key in ("mesh", "texture")]
        pack.writestr(ZipInfo("index.json"), json.dumps(index, indent=1), ZIP_DEFLATED)
        for file in dict.fromkeys(filter(None, files)):
            pack.writestr(ZipInfo(file), all_of_them.read(file), ZIP_DEFLATED)
    print(FILE, FILE.stat().st_size)


if __name__ == "__main__":
    main()
