"""Variations by rendering the same true state again."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.household.images.sources.images_server import picture
from tpvqa.errors import GeneratorError, PictureRefused
from tpvqa_household.images.manifest import Picture, load_pictures
from tpvqa_household.images.reachable import Reachable
from tpvqa_household.images.recipe import jobs
from tpvqa_household.images.sources.compose import compose
from tpvqa_household.images.sources.generator import Original
from tpvqa_household.images.sources.labels import labels
from tpvqa_household.images.sources.picture_file import read_picture
from tpvqa_household.images.sources.plan import Ingredients, plan
from tpvqa_household.images.sources.prompts import read_prompts
from tpvqa_household.images.sources.rerender import Rerender, jobs_by_visible
from tpvqa_household.images.sources.shares import Shares
from tpvqa_household.images.verify import verify

pytestmark = pytest.mark.rendering


@pytest.fixture(scope="module")
def rerender(shipped_reachable: list[Reachable]) -> Iterator[Rerender]:
    made = Rerender(jobs_by_visible(jobs(shipped_reachable)))
    yield made
    made.close()


@pytest.fixture(scope="module")
def entry() -> Picture:
    pictures = load_pictures().manifest.pictures
    return next(p for p in pictures if p.visible == "clean(plate), in_hand(plate), near(sink)")


def test_the_same_true_state_is_seen_otherwise(rerender: Rerender, entry: Picture) -> None:
    original = Original(load_pictures().read(entry), "", entry)
    one = rerender.vary(original, seed=1)
    assert rerender.vary(original, seed=1) == one
    other = rerender.vary(original, seed=2)
    assert other.data != one.data
    assert other.look != one.look
    for drawn in (one, other):
        assert drawn.renderer == "mujoco"
        assert drawn.seen is not None
        assert "(clean plate)" in drawn.seen
        assert read_picture(drawn.data).size == (224, 224)


def test_a_photo_is_only_taken_by_another_camera(rerender: Rerender) -> None:
    original = Original(picture(3, side=96), "")
    drawn = rerender.vary(original, seed=1)
    assert (drawn.renderer, drawn.seen) == (None, None)
    assert read_picture(drawn.data).size == (96, 96)


def test_where_no_other_view_serves_the_picture_is_taken_by_another_camera(
    rerender: Rerender, entry: Picture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tpvqa_household.images.sources.rerender.TRIES", 0)
    data = load_pictures().read(entry)
    drawn = rerender.vary(Original(data, "", entry), seed=1)
    assert drawn.data != data
    assert (drawn.seen, drawn.look, drawn.renderer) == (entry.seen, entry.look, entry.renderer)


def test_what_no_task_leads_to_is_refused(entry: Picture) -> None:
    with pytest.raises(PictureRefused, match="no task leads to"):
        Rerender({}).vary(Original(b"", "", entry), seed=1)


def test_it_cannot_read(rerender: Rerender) -> None:
    with pytest.raises(GeneratorError, match="makes no pictures from prompts"):
        rerender.generate("a plate", seed=1)


def test_a_set_of_rerendered_pictures_is_true(
    rerender: Rerender, shipped_reachable: list[Reachable], tmp_path: Path
) -> None:
    every = labels(shipped_reachable)
    wash = [label for label in every if "wash(" in label.shows.action]
    ingredients = Ingredients(wash, (), load_pictures(), read_prompts(every), varier=rerender)
    wanted = plan(ingredients, shares=Shares(), count=5)
    composed = compose(wanted, tmp_path, shipped_reachable)
    assert composed.refused == []
    gaps = verify(load_pictures(tmp_path), shipped_reachable).gaps
    assert [gap for gap in gaps if "needed" not in gap] == [], "only counts may be short"
    assert composed.manifest is not None
    varied = [p for p in composed.manifest.pictures if p.origin.kind == "variation"]
    assert len(varied) == 2 * 3
    originals = {p.file: p for p in load_pictures().manifest.pictures}
    for one in varied:
        assert one.seed == originals[one.origin.source].seed
        assert one.meshes == originals[one.origin.source].meshes
        assert one.look != originals[one.origin.source].look
    assert compose(wanted, tmp_path, shipped_reachable).made == 0
