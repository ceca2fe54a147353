"""Sets composed of photos, variations and pictures from prompts, over a real images server."""

import shutil
from collections import Counter, defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from tests.household.images.sources.images_server import Act, ImagesServer, refusal
from tpvqa.errors import GeneratorError, PictureSetError, WriteError
from tpvqa.worlds.pictures import MANIFEST
from tpvqa.worlds.simulation import Simulation
from tpvqa_household.images.manifest import Manifest, Picture, load_pictures
from tpvqa_household.images.reachable import Reachable
from tpvqa_household.images.sources.compose import Composed, compose, pending, rejected
from tpvqa_household.images.sources.labels import Label
from tpvqa_household.images.sources.openai_images import OpenAIImages
from tpvqa_household.images.sources.photos import read_photos
from tpvqa_household.images.sources.plan import Ingredients, Wanted, plan
from tpvqa_household.images.sources.prompts import read_prompts
from tpvqa_household.images.sources.shares import Shares
from tpvqa_household.images.verify import verify
from tpvqa_household.images.world import ImageWorld

Add = Callable[[str, int], Path]


@dataclass
class Kitchen:
    """All that a set for clean_dishes is composed from, but for a server."""

    labels: Sequence[Label]
    rendered: Path
    task: Reachable
    photos: Path
    out: Path
    price: float | None = 0.04
    options: dict[str, int] = field(default_factory=dict)

    def wanted(self, server: ImagesServer, **options: int) -> list[Wanted]:
        generator = OpenAIImages("some", base_url=server.url, price=self.price, retries=0)
        photos = read_photos(self.photos, self.labels) if self.photos.is_dir() else []
        return plan(
            Ingredients(
                self.labels,
                photos,
                load_pictures(self.rendered),
                read_prompts(self.labels),
                generator,
                generator,
            ),
            shares=Shares(),
            rejected=rejected(self.out),
            tasks=[self.task],
            **options,
        )

    def compose(self, server: ImagesServer, **options: int) -> Composed:
        return compose(self.wanted(server, **options), self.out, [self.task])


@pytest.fixture
def kitchen(
    clean_dishes: Reachable, dish_labels: list[Label], painted: Path, tmp_path: Path
) -> Kitchen:
    # `painted` fills the folder of the test itself.
    rendered = tmp_path / "rendered"
    rendered.mkdir()
    for path in [path for path in painted.iterdir() if path.is_file()]:
        path.rename(rendered / path.name)
    return Kitchen(dish_labels, rendered, clean_dishes, tmp_path / "photos", tmp_path / "set")


def by_label(manifest: Manifest) -> dict[str, list[Picture]]:
    found = defaultdict(list)
    for picture in manifest.pictures:
        shows = picture.origin.got_for
        if shows is not None:
            found[f"{shows.action} {shows.outcome}"].append(picture)
    return found


def made(folder: Path) -> dict[str, int]:
    return {path.name: path.stat().st_mtime_ns for path in folder.glob("*.jpg")}


def test_the_papers_shares_for_every_action_and_outcome(kitchen: Kitchen, add_photo: Add) -> None:
    for number in range(3):
        add_photo(f"wash_plate_sink/success/{number}.png", number)
    add_photo("wash_plate_sink/failure/one.png", 9)
    with ImagesServer() as server:
        composed = kitchen.compose(server)
        assert composed.refused == []
        assert composed.asked == len(server.requests) == 8 * 8
    manifest = load_pictures(kitchen.out).manifest
    assert manifest == composed.manifest
    found = by_label(manifest)
    assert len(found) == 8
    for label, pictures in found.items():
        kinds = Counter(picture.origin.kind for picture in pictures)
        assert (kinds.pop("variation"), kinds.pop("generated")) == (6, 2)
        photos = {"wash(plate, sink) success": 2, "wash(plate, sink) failure": 1}.get(label, 0)
        assert kinds == Counter(photo=photos, rendered=2 - photos)
    for picture in found["wash(plate, sink) success"]:
        assert "(clean plate)" in picture.state
        assert "(clean plate)" in picture.seen
        if picture.origin.kind == "variation":
            assert picture.origin.source.startswith("wash_plate_sink/success/")
            assert picture.origin.cost == 0.04
            assert "gleaming" in picture.origin.prompt
    files = [picture.origin.source for picture in manifest.pictures if not picture.origin.generator]
    assert len(files) == len(set(files)), "no picture stands in twice"


def test_a_composed_set_is_in_order_and_can_be_run(
    kitchen: Kitchen, simulate: Callable[..., Simulation]
) -> None:
    with ImagesServer() as server:
        kitchen.compose(server)
    assert verify(load_pictures(kitchen.out), [kitchen.task]).gaps == []
    world = ImageWorld(simulate(), folder=kitchen.out)
    assert world.observe().detail["picture"] in made(kitchen.out)


def test_a_composition_that_fails_goes_on_where_it_was(kitchen: Kitchen) -> None:
    with ImagesServer(script=lambda n: refusal(500, "broken") if n == 10 else None) as server:
        with pytest.raises(GeneratorError, match="the same command goes on from there"):
            kitchen.compose(server)
        first = made(kitchen.out)
        manifest = load_pictures(kitchen.out).manifest
        assert {picture.file for picture in manifest.pictures} == set(first)
        assert Counter(p.origin.kind for p in manifest.pictures)["variation"] > 0
        composed = kitchen.compose(server)
        assert len(server.requests) == 8 * 8 + 1, "only what failed was asked for twice"
        assert composed.asked == 8 * 8 - 10
        assert first.items() <= made(kitchen.out).items()
        assert kitchen.compose(server).made == 0
        assert len(server.requests) == 8 * 8 + 1


def test_a_picture_written_in_the_moment_of_a_kill_is_not_asked_for_again(
    kitchen: Kitchen,
) -> None:
    with ImagesServer() as server:
        whole = kitchen.compose(server, count=5).manifest
        asked = len(server.requests)
        (kitchen.out / MANIFEST).unlink()
        assert kitchen.compose(server, count=5).manifest == whole
        assert len(server.requests) == asked


def test_what_a_kill_left_half_written_is_taken_away(kitchen: Kitchen) -> None:
    with ImagesServer() as server:
        kitchen.compose(server, count=5)
        (kitchen.out / ".0123456789abcdef.part").write_bytes(b"half")
        kitchen.compose(server, count=5)
    assert not list(kitchen.out.glob(".*"))


def test_a_set_that_cannot_be_written_is_told_as_such(kitchen: Kitchen) -> None:
    kitchen.out.write_bytes(b"a file of the user's")
    with ImagesServer() as server, pytest.raises(WriteError, match=r"is no folder.*goes on with"):
        kitchen.compose(server, count=5)
    assert kitchen.out.read_bytes() == b"a file of the user's"


def test_a_damaged_picture_is_made_again(kitchen: Kitchen) -> None:
    with ImagesServer() as server:
        whole = kitchen.compose(server, count=5).manifest
        assert whole is not None
        broken = next(p.file for p in whole.pictures if p.origin.kind == "generated")
        (kitchen.out / broken).write_bytes(b"\xff\xd8")
        assert [one.file for one in pending(kitchen.wanted(server, count=5), kitchen.out)] == [
            broken
        ]
        asked = len(server.requests)
        assert kitchen.compose(server, count=5).asked == 1
        assert len(server.requests) == asked + 1


def test_a_refused_picture_is_left_out_and_asked_for_the_next_time(kitchen: Kitchen) -> None:
    refused = refusal(400, "a knife", code="moderation_blocked")
    with ImagesServer(script=lambda n: refused if n == 3 else None) as server:
        composed = kitchen.compose(server, count=5)
        assert len(composed.refused) == 1
        assert "a knife" in composed.refused[0]
        asked = len(server.requests)
        assert kitchen.compose(server, count=5).refused == []
        assert len(server.requests) == asked + 1


def test_a_rejected_picture_is_replaced_by_another(kitchen: Kitchen) -> None:
    with ImagesServer() as server:
        whole = kitchen.compose(server, count=5).manifest
        assert whole is not None
        (kitchen.out / "rejected").mkdir()
        for kind in ("generated", "variation", "rendered"):
            bad = next(p.file for p in whole.pictures if p.origin.kind == kind)
            shutil.move(kitchen.out / bad, kitchen.out / "rejected" / bad)
            before = len(server.requests)
            composed = kitchen.compose(server, count=5)
            assert composed.manifest is not None
            assert bad not in {picture.file for picture in composed.manifest.pictures}
            assert len(composed.manifest.pictures) == len(whole.pictures)
            if kind != "rendered":
                assert len(server.requests) == before + 1


def test_what_is_no_longer_wanted_is_kept_and_taken_back(kitchen: Kitchen, add_photo: Add) -> None:
    with ImagesServer() as server:
        before = kitchen.compose(server, count=5).manifest
        asked = len(server.requests)
        path = add_photo("wash_plate_sink/success/one.png", 1)
        kitchen.compose(server, count=5)
        assert len(server.requests) == asked + 3, "variations of the photo instead"
        assert len(list((kitchen.out / "unused").glob("*-variation-*.jpg"))) == 3
        path.unlink()
        assert kitchen.compose(server, count=5).manifest == before
        assert len(server.requests) == asked + 3


def test_a_slow_server_loses_nothing(kitchen: Kitchen) -> None:
    with ImagesServer(script=lambda n: Act(wait=0.3) if n == 0 else None) as server:
        assert kitchen.compose(server, count=5).refused == []


def test_a_set_that_was_built_is_left_alone(kitchen: Kitchen) -> None:
    kitchen.out = kitchen.rendered
    before = made(kitchen.rendered)
    with ImagesServer() as server, pytest.raises(PictureSetError, match="Name another folder"):
        kitchen.compose(server)
    assert made(kitchen.rendered) == before


@pytest.mark.parametrize(
    ("text", "count", "parts"),
    [
        ("20,60,20", 10, (2, 6, 2)),
        ("20, 60, 20", 3, (1, 2, 0)),
        ("0,100,0", 7, (0, 7, 0)),
        ("33,33,34", 10, (3, 3, 4)),
    ],
)
def test_shares_make_whole_pictures(text: str, count: int, parts: tuple[int, int, int]) -> None:
    assert Shares.parse(text).of(count) == parts


@pytest.mark.parametrize("text", ["20,60", "a,b,c", "50,50,50", "-20,100,20"])
def test_shares_that_are_none(text: str) -> None:
    with pytest.raises(PictureSetError, match=r"100|percentages"):
        Shares.parse(text)


def test_a_refused_key_leaves_a_folder_that_can_be_gone_on_in(kitchen: Kitchen) -> None:
    kitchen.out.mkdir()
    with ImagesServer(script=lambda n: refusal(401, "wrong") if n == 0 else None) as server:
        with pytest.raises(GeneratorError, match="refuses the key"):
            kitchen.compose(server, count=5)
        assert load_pictures(kitchen.out).manifest.pictures
        assert kitchen.compose(server, count=5).refused == []
