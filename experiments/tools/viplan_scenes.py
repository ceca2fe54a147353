"""Make the compact form of whole scenes as VLMs saw them.

python experiments/tools/viplan_scenes.py FOLDER, with `scenes.csv.gz` and `answers.csv.gz` in it.

Reads what the ViPlan benchmark recorded (Merler et al. 2025, MIT) and writes
`experiments/src/tpvqa_experiments/viplan/scenes.json.gz`: of every scene of blocksworld how the
blocks stood, and which answers about it were wrong. A scene that was looked at several times in an
episode, or in both settings, is kept once, as it was seen first.
"""

import argparse
import csv
import gzip
import json
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

OUT = Path(__file__).parents[1] / "src/tpvqa_experiments/viplan/scenes.json.gz"
SHORT = {
    "Qwen2.5-VL-72B-Instruct": "qwen2.5-vl-72b",
    "Qwen2.5-VL-7B-Instruct": "qwen2.5-vl-7b",
    "InternVL3-8B": "internvl3-8b",
    "aya-vision-8b": "aya-vision-8b",
    "gemma-3-12b-it": "gemma-3-12b",
    "gpt-4.1-nano": "gpt-4.1-nano",
    "Phi-4-multimodal-instruct": "phi-4-multimodal",
    "llava-onevision-qwen2-7b-ov-hf": "llava-onevision-7b",
}
Answers = Mapping[str, tuple[bool, bool]]
"""Whether a fact was affirmed, and whether it held."""


def table(path: Path) -> Iterator[dict[str, str]]:
    """The rows of a packed table."""
    with gzip.open(path, "rt", encoding="utf-8") as file:
        yield from csv.DictReader(file)


def columns_of(answers: Answers) -> list[str]:
    """The blocks of every column, from below."""
    held = [fact.split(" ") for fact, (_, truth) in answers.items() if truth]
    under = dict(words.split(",") for name, words in held if name == "on")
    column = dict(words.split(",") for name, words in held if name == "incolumn")
    names = sorted({fact.split(",")[1] for fact in answers if fact.startswith("incolumn")})

    def height(block: str) -> int:
        return 1 + height(under[block]) if block in under else 0

    return ["".join(sorted((b for b in column if column[b] == c), key=height)) for c in names]


def facts_of(columns: Sequence[str]) -> Iterator[str]:
    """The facts of a scene in the order in which wrong answers are noted."""
    blocks = "".join(columns)
    yield from (f"on {above},{below}" for above in blocks for below in blocks)
    yield from (f"clear {block}" for block in blocks)
    for block in blocks:
        yield from (f"incolumn {block},c{number + 1}" for number in range(len(columns)))


def main() -> None:
    """Write the compact form."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", type=Path)
    given = parser.parse_args()
    told = {
        row["scene"]: row
        for row in table(given.folder / "scenes.csv.gz")
        if row["environment"] == "blocksworld"
    }
    answers: dict[str, dict[str, tuple[bool, bool]]] = defaultdict(dict)
    for row in table(given.folder / "answers.csv.gz"):
        if row["scene"] in told and row["answer"] != "unknown":
            answers[row["scene"]][row["fact"]] = row["answer"] == "yes", row["truth"] == "1"
    kept: dict[tuple[str, str, str], list[object]] = {}
    for scene in sorted(told, key=lambda scene: (int(told[scene]["number"]) > 0, int(scene))):
        row, here = told[scene], answers[scene]
        columns = columns_of(here)
        wrong = "".join("01"[here[fact][0] != here[fact][1]] for fact in facts_of(columns))
        key = SHORT[row["model"]], row["problem"], ",".join(columns)
        kept.setdefault(key, [*key, row["number"] == "0", f"{int(wrong, 2):x}"])
    names = ["model", "problem", "columns", "initial", "wrong"]
    rows = sorted(kept.values(), key=str)
    text = json.dumps({"columns": names, "rows": rows}, separators=(",", ":"))
    with OUT.open("wb") as raw, gzip.GzipFile(fileobj=raw, mode="wb", mtime=0) as file:
        file.write(text.encode())
    print(f"{OUT}: {len(rows)} scenes, {OUT.stat().st_size} bytes")


if __name__ == "__main__":
    main()
