"""Shipped pictures arranged again: those that show a dirty plate show dirt that one sees."""

import pytest

from tpvqa.pddl import Atom
from tpvqa_household.images.build import LOOKS
from tpvqa_household.images.manifest import Picture, load_pictures
from tpvqa_household.kitchen.scene import KitchenScene

pytestmark = pytest.mark.rendering

CLEAN, COVERED = Atom("clean", ("plate",)), Atom("on", ("bread", "plate"))
HARDEST = [
    picture
    for picture in load_pictures().manifest.pictures
    if picture.meshes == "held_out"  # whose kitchens are as they were rendered
    and COVERED in picture.true_state
    and CLEAN.pddl() in picture.seen
    and CLEAN not in picture.true_state
]


@pytest.mark.parametrize("picture", HARDEST, ids=lambda picture: picture.file[:10])
def test_a_plate_that_is_seen_to_be_dirty_has_dirt_in_view(picture: Picture) -> None:
    assert picture.seed is not None
    scene = KitchenScene(seed=picture.seed, split="held_out")
    scene.repaint(picture.look // LOOKS)
    scene.arrange(picture.true_state, look=picture.look)
    found = scene.pixels()["dirt"]
    scene.close()
    assert found >= 100
