"""From names to a trial: what is refused, what is chosen, what a resumed trial is."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.doubles import configured
from tpvqa import Trial, TrialConfig
from tpvqa.belief import Calibration
from tpvqa.config import Limits
from tpvqa.episodes import EpisodeWriter, MemoryWriter, read_episode
from tpvqa.episodes.log import LOG
from tpvqa.errors import PluginError, TpvqaError, UnknownNameError
from tpvqa.events import Started
from tpvqa.events.events import Acted
from tpvqa.pddl import Atom, Literal, literals
from tpvqa.planning import Planner
from tpvqa.planning.fast_downward import FastDownward
from tpvqa.resuming import config_of, resume, trial_of
from tpvqa.tasks import find_task


@pytest.fixture(scope="module")
def planner() -> Iterator[Planner]:
    planner = FastDownward()
    yield planner
    planner.close()


def symbolic(**changes: object) -> TrialConfig:
    return configured(
        **{"task": "clean_dishes", "world": "symbolic", "monitor": "tpvqa", **changes}
    )


def test_an_option_that_nothing_takes_is_refused(planner: Planner) -> None:
    with pytest.raises(UnknownNameError, match=r"'majorty'.*Did you mean 'majority'"):
        Trial(symbolic(options={"majorty": "strict"}), planner=planner)
    with pytest.raises(PluginError, match="--simulator is for --world images"):
        Trial(symbolic(options={"simulator": "paper"}), planner=planner)
    with Trial(symbolic(options={"majority": "strict"}), planner=planner):
        pass


def test_without_pictures_the_vlm_is_a_noise_model_and_is_called_so(planner: Planner) -> None:
    with Trial(symbolic(), planner=planner) as trial:
        started = trial.started()
    assert (started.vlm, started.noise_model) == ("oracle", True)
    with Trial(symbolic(world="images"), planner=planner) as trial:
        started = trial.started()
    assert (started.vlm, started.noise_model) == ("embedded", False)


def test_only_who_looks_at_pictures_may_be_shown_what_holds_no_more(
    planner: Planner, tmp_path: Path
) -> None:
    given, questions = find_task("clean_dishes").questions, tmp_path / "questions.yaml"
    assert given is not None
    questions.write_text(given.read_text() + '\nstill_shown: ["(near ?x)"]\n')
    near = Literal(Atom("near", ("sink",)))
    for world, shown in (("symbolic", False), ("images", True)):
        config = symbolic(world=world, monitor="belief", questions=str(questions))
        with Trial(config, planner=planner) as trial:
            assert trial.parts.book.fact(near).still_shown is shown
            started = trial.started()
        assert started.questions is not None
        assert "still_shown" in started.questions
        with trial_of(started) as again:
            assert again.parts.book.fact(near).still_shown is shown


def test_a_vlm_that_looks_is_refused_where_there_is_nothing_to_see(planner: Planner) -> None:
    with pytest.raises(TpvqaError, match="looks at pictures"):
        Trial(symbolic(vlm="embedded"), planner=planner)


def test_a_trial_runs_once(planner: Planner) -> None:
    with Trial(symbolic(), planner=planner) as trial:
        trial.run(MemoryWriter())
        with pytest.raises(TpvqaError, match="has run already"):
            trial.run(MemoryWriter())


@pytest.fixture
def half(tmp_path: Path, planner: Planner) -> Path:
    """The first half of an episode with questions of the user's own."""
    questions = tmp_path / "mine.yaml"
    text = Path(str(find_task("clean_dishes").questions)).read_text(encoding="utf-8")
    questions.write_text(text.replace("clean?", "shining?"), encoding="utf-8")
    folder = tmp_path / "episode"
    with Trial(symbolic(questions=str(questions)), planner=planner) as trial:
        writer = EpisodeWriter(folder)
        trial.run(writer)
        writer.close()
    lines = (folder / LOG).read_bytes().splitlines(keepends=True)
    (folder / LOG).write_bytes(b"".join(lines[: len(lines) // 2]))
    return folder


def test_a_resumed_trial_asks_in_the_words_it_began_with(half: Path) -> None:
    resume(half)
    asked = [q.text for e in read_episode(half) if e.kind == "asked" for q in e.questions]
    assert "Is the plate shining?" in asked
    assert "Is the plate clean?" not in asked


def test_what_the_log_keeps_goes_before_the_files_that_it_names(half: Path) -> None:
    (half.parent / "mine.yaml").write_text("predicates: {}\n", encoding="utf-8")
    resume(half)
    asked = [q.text for e in read_episode(half) if e.kind == "asked" for q in e.questions]
    assert "Is the plate shining?" in asked[len(asked) // 2 :]


def test_a_resumed_trial_is_configured_as_it_began(tmp_path: Path, planner: Planner) -> None:
    config = configured(
        task="clean_dishes",
        world="symbolic",
        vlm="oracle:0.9",
        monitor="belief:question=0.05",
        planner="fast-downward:optimal",
        failure=0.4,
        limits=Limits(repeats=3, actions=33, seconds=500.0),
        seed=5,
        episode=2,
    )
    writer = EpisodeWriter(tmp_path)
    with Trial(config, calibration=Calibration.default("oracle:0.9")) as trial:
        trial.run(writer)
    writer.close()
    started = read_episode(tmp_path)[0]
    assert isinstance(started, Started)
    assert config_of(started) == config
    with trial_of(started) as again:
        assert again.parts.planner.name == "fast-downward:optimal"
        assert again.calibration == Calibration.default("oracle:0.9")
        assert again.started() == started.model_copy(update={"number": -1, "time": 0.0})


def test_a_wrong_done_says_what_of_the_goal_is_not_so(planner: Planner) -> None:
    told = []
    for episode in range(12):
        with Trial(symbolic(monitor="blind:1", episode=episode), planner=planner) as trial:
            ended = trial.run(writer := MemoryWriter())
            goal, true = trial.parts.task.goal, trial.parts.task.init
        for event in writer.events:
            if isinstance(event, Acted) and event.truth is not None:
                added = {Atom.parse(fact) for fact in event.truth.added}
                true = (true - {Atom.parse(fact) for fact in event.truth.removed}) | added
        missing = tuple(each.pddl() for each in literals(goal) if not each.holds(true))
        assert (ended.unmet or ()) == missing
        told.append(missing)
    assert () in told
    assert any(told)
