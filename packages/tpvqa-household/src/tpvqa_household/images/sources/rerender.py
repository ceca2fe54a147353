"""Variations without a model: the same true state rendered again, as another camera takes it."""

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from PIL import Image

from tpvqa.chance import chance
from tpvqa.errors import GeneratorError, PictureRefused
from tpvqa_household.images.contrast import overlooked
from tpvqa_household.images.manifest import Picture
from tpvqa_household.images.recipe import FACTS, Job, objection
from tpvqa_household.images.sources.generator import Drawn, Original
from tpvqa_household.images.sources.photographic import photographed
from tpvqa_household.images.sources.picture_file import as_jpeg, read_picture
from tpvqa_household.kitchen.layout import Split

if TYPE_CHECKING:
    from tpvqa_household.kitchen.scene import KitchenScene

SIDE = 224
TRIES = 24
"""Views of a kitchen that are tried for one variation."""
_SPLITS: Mapping[str, Split] = {"known": "train", "held_out": "held_out"}


class Rerender:
    """Renders the kitchen of a picture again by MuJoCo: other light, view, colours, camera.

    A photo cannot be rendered again: it is only changed as another camera would change it. So is a
    picture of which no other view of its kitchen shows all that matters.

    Args:
        jobs: For each visible state, as the manifest writes it, what every picture of it must
            and must not show.

    Raises:
        MissingExtraError: MuJoCo is not installed.
        WorldError: There is no graphics library to draw with.
    """

    name = "rerender"
    settings = "1"
    remote = False
    price: float | None = 0.0
    requests = 0

    def __init__(self, jobs: Mapping[str, Job]):
        from tpvqa_household.kitchen.gl import load_mujoco

        load_mujoco()
        self._jobs = jobs
        self._scene: KitchenScene | None = None

    def vary(self, original: Original, *, seed: int) -> Drawn:
        """The same true state, seen otherwise."""
        entry = original.picture
        if entry is None or entry.seed is None:
            return Drawn(as_jpeg(photographed(read_picture(original.data), seed)))
        job = self._jobs.get(entry.visible)
        if job is None:
            raise PictureRefused(f"no task leads to what {entry.file} shows: {entry.visible}")
        scene = self._kitchen(entry)
        draw = chance(seed, 0, "rerender")
        scene.repaint(draw.randrange(1, 1_000_000))
        for _ in range(TRIES):
            look = draw.randrange(1_000, 1_000_000)
            scene.arrange(entry.true_state, look=look)
            shown = scene.shown()
            if objection(
                job,
                entry.true_state,
                {atom: shown[atom].true for atom in FACTS},
                {atom: shown[atom].visible for atom in FACTS},
            ):
                continue
            pixels = scene.render()
            if not overlooked(scene, pixels):
                seen = frozenset(atom.pddl() for atom in FACTS if shown[atom].visible)
                image = photographed(Image.fromarray(pixels), seed)
                return Drawn(as_jpeg(image), seen=seen, renderer="mujoco", look=look)
        # A bun hides nearly all dirt of a small plate: no other view of this kitchen shows it.
        image = photographed(read_picture(original.data), seed)
        return Drawn(as_jpeg(image), seen=entry.seen, renderer=entry.renderer, look=entry.look)

    def generate(self, prompt: str, *, seed: int) -> Drawn:
        """Not possible: it cannot read."""
        raise GeneratorError(
            "'rerender' makes no pictures from prompts. Write --prompts openai:MODEL or "
            "--prompts diffusers:MODEL, or --prompts none"
        )

    def close(self) -> None:
        """Free the canvas. Can be called twice."""
        scene, self._scene = self._scene, None
        if scene is not None:
            scene.close()

    def _kitchen(self, entry: Picture) -> "KitchenScene":
        """The last kitchen, or another: compiling one takes as long as some pictures."""
        from tpvqa_household.kitchen.scene import KitchenScene

        wanted = (entry.seed, _SPLITS[entry.meshes])
        if self._scene is None or (self._scene.seed, self._scene.split) != wanted:
            self.close()
            assert entry.seed is not None
            self._scene = KitchenScene(seed=entry.seed, split=wanted[1], size=SIDE)
        return self._scene


def jobs_by_visible(jobs: list[Job]) -> dict[str, Job]:
    """One job for every visible state."""
    return {job.key[0]: replace(job, number=0) for job in jobs}
