"""Make the compact form of recorded VLM answers: `python tools/compact_answers.py ANSWERS.csv.gz`.

Reads the table of answers recorded by the ViPlan benchmark (Merler et al. 2025, MIT) and writes
`packages/tpvqa/src/tpvqa/vlm/recorded/answers.json.gz`: how often each model gave which answer with
which P(yes), by environment, kind of question, predicate, truth, and half of the problems.
"""

import argparse
import csv
import gzip
import json
from collections import Counter
from pathlib import Path

from tpvqa.vlm.recorded.answers import half_of

OUT = Path(__file__).parents[1] / "packages/tpvqa/src/tpvqa/vlm/recorded/answers.json.gz"
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


def main() -> None:
    """Write the compact form."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("answers", type=Path)
    given = parser.parse_args()
    counts: Counter[tuple[str, str, str, str, int, int, str, float]] = Counter()
    with gzip.open(given.answers, "rt", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            key = (
                SHORT[row["model"]],
                row["environment"],
                row["kind"],
                row["fact"].split(" ")[0],
                int(row["truth"]),
                half_of(row["problem"]),
                row["answer"],
                round(float(row["p_yes"]), 2),
            )
            counts[key] += 1
    rows = [[*key, count] for key, count in sorted(counts.items())]
    columns = ["model", "environment", "kind", "predicate", "truth", "half", "answer", "p_yes", "n"]
    text = json.dumps({"columns": columns, "rows": rows}, separators=(",", ":"))
    with OUT.open("wb") as raw, gzip.GzipFile(fileobj=raw, mode="wb", mtime=0) as file:
        file.write(text.encode())
    print(f"{OUT}: {sum(counts.values())} answers in {len(rows)} rows, {OUT.stat().st_size} bytes")


if __name__ == "__main__":
    main()
