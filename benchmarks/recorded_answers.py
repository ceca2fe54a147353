"""What recording and replaying an answer costs: time of a look, bytes of an answer.

python benchmarks/recorded_answers.py [--looks 2000]
"""

import argparse
import statistics
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from tpvqa.observation import Frame, Observation
from tpvqa.pddl import Atom
from tpvqa.questions import FactQuestion, Question, Way
from tpvqa.vlm import Answer, Reply
from tpvqa.vlm.kept import AnswerFile, Use
from tpvqa.vlm.kept.vlm import CountingVLM

QUESTIONS = [
    FactQuestion(f"Is thing {number} there?", Way.EFFECT, Atom("there")) for number in range(8)
]
PICTURE = b"\xff\xd8" + bytes(30_000)


class Yes:
    """Takes no time."""

    name = "yes"

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        """Say yes."""
        return [Answer(each, Reply.YES, p_yes=0.9, source="logprobs") for each in questions]


def timed(path: Path, use: Use, looks: int) -> list[float]:
    """Milliseconds of each look with eight questions, every picture new, of 30 kB."""
    file = AnswerFile(path, writing=use is not Use.REPLAY)
    model = file.models()[0][0] if use is Use.REPLAY else file.model("yes", {})
    inner = None if use is Use.REPLAY else Yes()
    vlm = CountingVLM(
        file, model, use=use, name="yes", stands_for=Yes, inner=inner, trial=b"benchmark"
    )
    found = []
    for look in range(looks):
        frame = Frame("a", "front", PICTURE + look.to_bytes(4, "big"))
        began = time.perf_counter()
        vlm.ask(Observation(look, frames={"front": frame}), QUESTIONS)
        found.append((time.perf_counter() - began) * 1000)
    vlm.close()
    return found


def main() -> None:
    """Print medians and the 95% quantile."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--looks", type=int, default=2000)
    looks = parser.parse_args().looks
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "answers.db"
        for use in (Use.RECORD, Use.CACHE, Use.REPLAY):
            found = sorted(timed(path, use, looks))
            late = found[int(0.95 * len(found))]
            print(f"{use}: {statistics.median(found):.2f} ms a look, {late:.2f} at 95 %")
        print(f"{path.stat().st_size / (looks * len(QUESTIONS)):.0f} bytes an answer")


if __name__ == "__main__":
    main()
