"""A belief monitor turns to another wording where the errors of one last."""

from pathlib import Path

import pytest

from tpvqa.assembly import Trial
from tpvqa.config import TrialConfig
from tpvqa.episodes import MemoryWriter
from tpvqa.events.events import Asked, Event
from tpvqa.pddl import load_task
from tpvqa.questions import QuestionBook
from tpvqa.tasks import find_task

TASK = load_task("clean_dishes")
ONE = '  near: "Is there a {x} in the image?"\n'
SEVERAL = '  near: ["Is there a {x} in the image?", "Can a {x} be seen?"]\n'


def asked(folder: Path, near: str, vlm: str, episode: int) -> list[tuple[str, int | None]]:
    """Every question of a trial, with which wording it is in."""
    path = folder / "questions.yaml"
    given = find_task("clean_dishes").questions
    assert given is not None
    path.write_text(given.read_text().replace(ONE, near))
    writer = MemoryWriter()
    config = TrialConfig(
        task="clean_dishes", world="symbolic", vlm=vlm, monitor="belief", seed=5, episode=episode
    )
    with Trial(config, task=TASK, book=QuestionBook.load(path, TASK)) as trial:
        trial.run(writer)
    events: list[Event] = writer.events
    each = [q for event in events if isinstance(event, Asked) for q in event.questions]
    return [(question.text, question.wording) for question in each]


def test_where_errors_last_it_asks_in_other_words_and_the_first_ones_first(tmp_path: Path) -> None:
    told = asked(tmp_path, SEVERAL, "oracle:0.8:0:1:words:0", 3)
    seen = [wording for text, wording in told if "seen" in text]
    assert seen
    assert set(seen) == {1}
    for text, wording in told:
        if wording:
            thing = text.removeprefix("Can a ").removesuffix(" be seen?")
            first = next(n for n, (t, _) in enumerate(told) if f" {thing} in the image" in t)
            assert first < told.index((text, wording))


@pytest.mark.parametrize("vlm", ["oracle:0.8:0:0.74", "recorded:gemma-3-12b"])
def test_a_list_of_one_wording_is_that_wording(tmp_path: Path, vlm: str) -> None:
    listed = '  near: ["Is there a {x} in the image?"]\n'
    assert asked(tmp_path, listed, vlm, 0) == asked(tmp_path, ONE, vlm, 0)
