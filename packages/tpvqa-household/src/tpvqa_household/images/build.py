"""Makes a set of pictures: kitchens arranged, checked, rendered, written one by one.

The manifest names only pictures that are whole on disk, and is replaced in one step after each
of them, so a build can be stopped at any moment and goes on where it was.
"""

import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from io import BytesIO
from itertools import groupby
from multiprocessing import get_context
from multiprocessing.util import Finalize
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from tpvqa.chance import chance
from tpvqa.errors import PictureError, PictureSetError
from tpvqa.pictures import read_file
from tpvqa.worlds.pictures import digest
from tpvqa_household.images.contrast import overlooked
from tpvqa_household.images.manifest import Manifest, Picture, Renderer
from tpvqa_household.images.own_pictures import existing, left_behind, see_own, was_built
from tpvqa_household.images.recipe import FACTS, TRIES, Job, objection
from tpvqa_household.images.writing import alone, replace, write_manifest
from tpvqa_household.kitchen.layout import Split

if TYPE_CHECKING:
    from tpvqa_household.kitchen.scene import KitchenScene

_COMMAND = "tpvqa dataset build"
SIDE = 224
QUALITY = 85
LOOKS = 4
"""Views of a kitchen that are tried before the next kitchen is."""


@dataclass(frozen=True, slots=True)
class Settings:
    """How pictures are rendered.

    Attributes:
        renderer: "cycles" or "mujoco".
        blender: The Python that has Blender, for Cycles.
        samples: Paths a pixel.
        size: Side of what Cycles renders before it is scaled down.
        threads: Of each Blender.
    """

    renderer: Renderer
    blender: Path | None = None
    samples: int = 8
    size: int = SIDE
    threads: int = 1


@dataclass(frozen=True, slots=True)
class Made:
    """A picture that was made, not yet on disk."""

    job: Job
    data: bytes
    picture: Picture


def build(
    jobs: Sequence[Job],
    folder: Path,
    settings: Settings,
    *,
    workers: int = 1,
    progress: Callable[[int, int], None] | None = None,
) -> Manifest:
    """Make what is missing of a set, or was rendered otherwise, in a folder.

    Args:
        jobs: What the set consists of.
        folder: Where it lies or shall lie.
        settings: How pictures are rendered.
        workers: Processes.
        progress: Told the number of pictures done and of all, after each.

    Raises:
        PictureSetError: A picture could not be made, or another build is at work there.
        WriteError: The folder cannot be written to; what was made stays.
    """
    with alone(folder):
        return _build(jobs, folder, settings, workers, progress or (lambda done, total: None))


def _build(
    jobs: Sequence[Job],
    folder: Path,
    settings: Settings,
    workers: int,
    progress: Callable[[int, int], None],
) -> Manifest:
    wanted = {job.key: job for job in jobs}
    there = existing(folder, was_built, _COMMAND)
    see_own(folder, {picture.file for picture in there}, _COMMAND)
    known = {(picture.visible, picture.number): picture for picture in there}
    kept = {key: picture for key, picture in known.items() if key in wanted}
    missing = [
        job
        for job in jobs
        if job.key not in kept or not _current(kept[job.key], job, settings, folder)
    ]
    done = len(jobs) - len(missing)
    progress(done, len(jobs))
    for made in _made(missing, settings, workers):
        replaced = kept.get(made.job.key)
        kept[made.job.key] = made.picture
        replace(folder / made.picture.file, made.data)
        _write(folder, kept)
        if replaced is not None and replaced.file != made.picture.file:
            (folder / replaced.file).unlink(missing_ok=True)
        done += 1
        progress(done, len(jobs))
    manifest = _write(folder, kept)
    listed = {picture.file for picture in manifest.pictures}
    own = {picture.file for picture in there}
    for path in folder.glob("*.jpg"):
        if path.name not in listed and (path.name in own or left_behind(path)):
            path.unlink()
    return manifest


def _current(picture: Picture, job: Job, settings: Settings, folder: Path) -> bool:
    """Whether a picture on disk is what the job would make."""
    return (
        picture.renderer == settings.renderer
        and picture.meshes == job.meshes
        and picture.seed is not None
        and job.seed <= picture.seed < job.seed + TRIES
        and set(picture.shows) == set(job.shows)
        and picture.true_state in job.states
        and _whole(picture, folder)
    )


def _whole(picture: Picture, folder: Path) -> bool:
    try:
        return digest(read_file(picture.file, inside=folder)) == picture.sha256
    except PictureError:
        return False


def _made(missing: Sequence[Job], settings: Settings, workers: int) -> Iterator[Made]:
    if workers <= 1:
        with _Maker(settings) as maker:
            for job in missing:
                yield maker.make(job)
        return
    pool = ProcessPoolExecutor(
        workers, mp_context=get_context("spawn"), initializer=_start, initargs=(settings,)
    )
    try:
        kitchens = groupby(missing, key=lambda job: job.seed)
        futures = [pool.submit(_work, list(sharing)) for _, sharing in kitchens]
        for future in as_completed(futures):
            yield from future.result()
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


_maker: "_Maker | None" = None


def _start(settings: Settings) -> None:
    global _maker
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent ends its workers
    _maker = _Maker(settings)
    Finalize(None, _maker.close, exitpriority=0)  # worker processes run no `atexit`


def _work(sharing: Sequence[Job]) -> list[Made]:
    assert _maker is not None
    return [_maker.make(job) for job in sharing]


class _Maker:
    """Arranges and renders in one process."""

    def __init__(self, settings: Settings):
        self._settings = settings
        self._cycles: Any = None
        self._scene: KitchenScene | None = None

    def __enter__(self) -> "_Maker":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End Blender and free the canvas."""
        if self._scene is not None:
            self._scene.close()
        if self._cycles is not None:
            self._cycles.close()

    def make(self, job: Job) -> Made:
        """Find a kitchen and a view that can serve a job, and render it.

        Raises:
            PictureSetError: None of the job's kitchens can.
        """
        reasons = []
        for seed in range(job.seed, job.seed + TRIES):
            state = chance(seed, job.turn, "true state").choice(job.states)
            scene = self._kitchen(seed, job)
            scene.repaint(job.turn)
            for look in range(job.turn * LOOKS, (job.turn + 1) * LOOKS):
                scene.arrange(state, look=look)
                shown = scene.shown()
                reason = objection(
                    job,
                    state,
                    {atom: shown[atom].true for atom in FACTS},
                    {atom: shown[atom].visible for atom in FACTS},
                )
                if reason is None:
                    seen = frozenset(atom.pddl() for atom in FACTS if shown[atom].visible)
                    pixels = self._render(scene, look)
                    faint = overlooked(scene, pixels)
                    if not faint:
                        data = _encoded(pixels)
                        return Made(job, data, self._picture(job, seed, look, data, state, seen))
                    reason = f"the {' and the '.join(faint)} would hardly stand out"
                reasons.append(f"kitchen {seed}, look {look}: {reason}")
        raise PictureSetError(
            f"No kitchen shows {job.key[0]} well. The last tries: {'; '.join(reasons[-3:])}"
        )

    def _kitchen(self, seed: int, job: Job) -> "KitchenScene":
        """The last kitchen, or another: jobs that share one come after each other."""
        from tpvqa_household.kitchen.scene import KitchenScene

        split: Split = "train" if job.meshes == "known" else "held_out"
        if self._scene is None or (self._scene.seed, self._scene.split) != (seed, split):
            if self._scene is not None:
                self._scene.close()
            self._scene = KitchenScene(seed=seed, split=split, size=SIDE)
        return self._scene

    def _picture(
        self, job: Job, seed: int, look: int, data: bytes, state: Any, seen: frozenset[str]
    ) -> Picture:
        visible, number = job.key
        sha256 = digest(data)
        return Picture(
            file=f"{digest(visible.encode())[:8]}-{number}-{sha256[:8]}.jpg",
            sha256=sha256,
            width=SIDE,
            height=SIDE,
            renderer=self._settings.renderer,
            meshes=job.meshes,
            seed=seed,
            look=look,
            visible=visible,
            number=number,
            state=tuple(atom.pddl() for atom in sorted(state)),
            seen=seen,
            shows=job.shows,
        )

    def _render(self, scene: "KitchenScene", look: int) -> NDArray[np.uint8]:
        if self._settings.renderer == "mujoco":
            pixels: NDArray[np.uint8] = scene.render()
            return pixels
        from tpvqa_household.images.blender import Cycles, find_blender_python
        from tpvqa_household.images.scene_file import scene_arrays

        if self._cycles is None:
            self._cycles = Cycles(
                find_blender_python(self._settings.blender),
                size=self._settings.size,
                samples=self._settings.samples,
                threads=self._settings.threads,
            )
        rendered: NDArray[np.uint8] = self._cycles.render(scene_arrays(scene, look=look))
        return rendered


def _encoded(pixels: NDArray[np.uint8]) -> bytes:
    image = Image.fromarray(pixels)
    if image.size != (SIDE, SIDE):
        image = image.resize((SIDE, SIDE), Image.Resampling.LANCZOS)
    buffer = BytesIO()
    image.save(buffer, "JPEG", quality=QUALITY, optimize=True)
    return buffer.getvalue()


def _write(folder: Path, kept: dict[tuple[str, int], Picture]) -> Manifest:
    manifest = Manifest(
        facts=tuple(atom.pddl() for atom in FACTS),
        pictures=tuple(sorted(kept.values(), key=lambda p: (p.visible, p.number))),
    )
    write_manifest(folder, manifest)
    return manifest
