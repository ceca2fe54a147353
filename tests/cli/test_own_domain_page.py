"""From two PDDL files to a labelled, calibrated run: the commands of docs/your-own-domain.md."""

import re
import shlex
import shutil
import sys
from collections.abc import Iterator
from glob import glob
from io import StringIO
from pathlib import Path

import pytest

from tests.cli.conftest import Run
from tests.labelling.robot import WARD
from tests.test_own_robot import PAGE, Edit, package
from tpvqa.belief import Calibration
from tpvqa.episodes import read_episode
from tpvqa.events.events import Acted, Ended, Started
from tpvqa.labelling import LABELS, Session
from tpvqa.vlm import Reply

__all__ = ["package"]
HEADING = "## 5. What your VLM's answers are worth"
LAB = """
from io import BytesIO
from pathlib import Path
from random import Random

from PIL import Image

from tpvqa.pddl import Literal, load_task
from tpvqa.questions import QuestionBook

task = load_task("domain.pddl", "problem.pddl")
book = QuestionBook.load(Path("questions.yaml"), task)
facts = {book.fact(Literal(atom)).text: atom for atom in task.atoms() | task.init}
state, chance = task.init, Random(4)


def take_picture():
    picture = Image.linear_gradient("L").resize((64, 48)).convert("RGB")
    picture.paste((200, 40, 40), (chance.randrange(40), chance.randrange(30), 60, 46))
    picture.paste((20, 40, 240), (chance.randrange(20), 0, 30 + chance.randrange(20), 20))
    data = BytesIO()
    picture.save(data, "JPEG")
    return data.getvalue()


def run_skill(name, arguments):
    global state
    action = task.action(name, arguments)
    if chance.random() < 0.9 and task.applicable(state, action):
        state = task.apply(state, action)
    return True


def probability_of_yes(picture, text):
    right = chance.random() < 0.95
    return 0.95 if (facts[text] in state) == right else 0.05
"""


class Fingers(StringIO):
    """Somebody who says what most answers say, to every question."""

    def readline(self, _size: int | None = -1, /) -> str:  # type: ignore[override]
        with Session(["episodes/1"]) as session:
            now = session.now
        if now is None:
            return "q\n"
        yes = [each.reply is Reply.YES for each in now.of_vlm]
        return "y\n" if sum(yes) * 2 > len(yes) else "n\n"


def commands() -> Iterator[list[str]]:
    """The commands of the section's first block, as a shell would give them."""
    section = PAGE.read_text().partition(HEADING)[2]
    block = re.findall(r"```sh\n(.*?)```", section, re.DOTALL)[0]
    for line in block.splitlines():
        program, *words = shlex.split(line, comments=True)
        assert program == "tpvqa"
        yield words


def test_the_commands_lead_to_a_calibrated_run(
    package: Edit,
    tpvqa: Run,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    for file in WARD.iterdir():
        shutil.copy(file, tmp_path)
    (tmp_path / "site" / "my_lab.py").write_text(LAB)
    done = []
    for words in commands():
        for module in [
            each for each in sys.modules if each.split(".")[0] in ("my_package", "my_lab")
        ]:
            del sys.modules[module]
        monkeypatch.setattr(sys, "stdin", Fingers())
        given = [name for word in words for name in (sorted(glob(word)) or [word])]
        code, out, err = tpvqa(*given)
        assert code == 0, (given, out, err)
        done.append(words[0])
    assert done == ["run", "label", "calibrate", "run", "report"]
    labels = len(Path("episodes/1", LABELS).read_text().splitlines())
    assert labels > 10
    calibration = Calibration.load(Path("calibration.json"))
    assert calibration.by_hand == labels
    started, *events = read_episode("episodes/2")
    assert isinstance(started, Started)
    assert started.calibration == calibration.model_dump(mode="json")
    assert not any(isinstance(each, Acted) and each.truth for each in events)
    ended = events[-1]
    assert isinstance(ended, Ended)
    page = Path("episodes/2/report.html").read_text()
    assert f"by {labels} labels ({calibration.fingerprint})" in page
