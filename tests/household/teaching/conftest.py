"""What was taught once, for all tests here."""

from pathlib import Path

import pytest

from tests.household.teaching.lamps import make
from tests.lamps import DOMAIN, PROBLEM, QUESTIONS
from tpvqa.pddl import load_task
from tpvqa.questions import QuestionBook
from tpvqa.training.from_pictures import examples_of
from tpvqa.training.protocol import TrainingSettings
from tpvqa.worlds.pictures import load_set
from tpvqa_household.teaching.trainer import EmbeddedTrainer


@pytest.fixture(scope="session")
def lamp_set(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make(tmp_path_factory.mktemp("lamps") / "set", 48)


@pytest.fixture(scope="session")
def taught(lamp_set: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a network that was taught all of the lamps."""
    book = QuestionBook.load(QUESTIONS, load_task(DOMAIN, PROBLEM))
    trainer, here = EmbeddedTrainer(), tmp_path_factory.mktemp("taught")
    examples = list(examples_of(load_set(lamp_set), [book]))
    trainer.fit(
        examples, here, settings=TrainingSettings(epochs=1), progress=lambda done, total: None
    )
    assert trainer.save(here / "lamps") == f"embedded:{here / 'lamps'}"
    return here / "lamps"
