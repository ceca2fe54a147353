"""Numbers of a compiled kitchen's parts by name, and which thing each geom belongs to."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tpvqa_household.kitchen.assets import Model, Part
from tpvqa_household.kitchen.gl import load_mujoco
from tpvqa_household.kitchen.household import FIXTURES, HANDS, ITEMS

LABELS = ("nothing", *ITEMS, *FIXTURES, "screen", "dirt", "inside", "room", *HANDS)
DRAWN = 3
"""Geoms of this group and above are not drawn."""


class Names:
    """Looks up the parts of one compiled scene.

    Args:
        model: The compiled scene.
        models: What stands for each thing in it.

    Attributes:
        body: Number of each body.
        mocap: Number of each body that is put where it is wanted; -1 for others.
        material: Number of each material.
        geom: Number of each geom.
        joint: Where the position of each joint starts.
        geoms_of: The drawn geoms of each thing; a plate's dirt is a thing of its own.
    """

    def __init__(self, model: Any, models: Mapping[str, Model]):
        kinds = load_mujoco().mjtObj
        bodies = _names(model, kinds.mjOBJ_BODY, model.nbody)
        geoms = _names(model, kinds.mjOBJ_GEOM, model.ngeom)
        materials = _names(model, kinds.mjOBJ_MATERIAL, model.nmat)
        joints = _names(model, kinds.mjOBJ_JOINT, model.njnt)
        self.body = {name: k for k, name in enumerate(bodies)}
        self.mocap = {name: int(model.body_mocapid[k]) for k, name in enumerate(bodies)}
        self.material = {name: k for k, name in enumerate(materials)}
        self.geom = {name: k for k, name in enumerate(geoms) if name}
        self.joint = {name: int(model.jnt_qposadr[k]) for k, name in enumerate(joints)}
        labels = [_label(name, models) for name in geoms]
        self._label = np.array([LABELS.index(label) for label in labels])
        self.geoms_of: dict[str, list[int]] = {}
        for k, (name, label) in enumerate(zip(geoms, labels, strict=True)):
            if model.geom_group[k] < DRAWN:
                thing = label if label == "dirt" else name.split("/")[0]
                self.geoms_of.setdefault(thing, []).append(k)

    def mask(self, thing: str, geoms: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Which pixels show a thing.

        Args:
            thing: One of `LABELS`.
            geoms: The number of the geom that each pixel shows.
        """
        labels = np.append(self._label, LABELS.index("nothing"))
        return np.asarray(labels[geoms] == LABELS.index(thing))

    def by_thing(self, by_geom: NDArray[np.int64]) -> dict[str, int]:
        """Pixels of each thing from the pixels of each geom. What is on a thing is of it too."""
        sums = np.bincount(self._label, weights=by_geom[: len(self._label)], minlength=len(LABELS))
        counts = {name: int(n) for name, n in zip(LABELS, sums, strict=True)}
        counts["plate"] += counts["dirt"]
        counts["tv"] += counts["screen"]
        counts["fridge"] += counts["inside"]
        return counts


def _names(model: Any, kind: Any, count: int) -> list[str]:
    return [load_mujoco().mj_id2name(model, kind, k) or "" for k in range(count)]


def _inner(part: Part) -> bool:
    """Whether a part of the fridge shows only while the door is open."""
    return not part.body and part.paint in ("inside", "shelf", "edge", "lamp")


def _label(geom: str, models: Mapping[str, Model]) -> str:
    thing, _, part = geom.partition("/")
    if thing in ("half_a", "half_b"):
        return "apple"
    if thing.startswith(("wall_", "tiles", "ceiling")):
        return "room"
    if thing.startswith("counter"):
        return "counter"
    if thing == "tv" and part in {p.name for p in models["tv"].parts_with("screen")}:
        return "screen"
    if thing == "fridge" and part in {p.name for p in models["fridge"].parts if _inner(p)}:
        return "inside"
    if thing == "sink":
        wet = {p.name for role in ("basin", "tap") for p in models["sink"].parts_with(role)}
        return "sink" if not wet or part in wet else "counter"
    if thing == "plate" and part in {p.name for p in models["plate"].parts_with("dirt")}:
        return "dirt"
    return thing if thing in LABELS else "nothing"
