"""Furnishes a layout: draws a model for every thing and writes MuJoCo's scene description."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np

from tpvqa_household.kitchen.assets import Model, distractors, draw, soiled
from tpvqa_household.kitchen.assets.textures import Use, draw_texture
from tpvqa_household.kitchen.household import HANDS, ITEMS
from tpvqa_household.kitchen.layout import Layout, Split, Stand, draw_layout

DISTRACTORS = 7
COVER = 0.6
"""Share of the plate that the bread may hide."""
ROOM: Mapping[str, Use] = {"wall": "wall", "floor": "floor", "tiles": "wall"}
"""Surfaces of the room itself, and the kind of texture that each has."""
ROOM_CHOICE = 3
"""Textures of each that a kitchen can be repainted with."""
_AMBIGUOUS = {"fruits", "breadbox", "hotdog", "hamburger", "croissant"}
"""Kinds in which a person may see an apple or bread: they are no distractors."""


@dataclass(frozen=True)
class Furniture:
    """The chosen models and the scene made of them.

    Attributes:
        layout: Where the furniture stands.
        xml: MuJoCo's description of the scene.
        files: The meshes and textures it names.
        models: The model of each named thing.
        loose: Names of the distractors.
    """

    layout: Layout
    xml: str = field(repr=False)
    files: Mapping[str, bytes] = field(repr=False)
    models: Mapping[str, Model]
    loose: tuple[str, ...]


def furnish(rng: np.random.Generator, split: Split, *, size: int) -> Furniture:
    """Choose a model for every thing, and put the fixtures into a random room.

    Args:
        rng: Decides everything.
        split: Which models, textures and layouts.
        size: Height and width of the largest picture to draw, pixels.
    """

    def pick(kind: str) -> Model:
        return draw(kind, rng, split=split)

    models = {item: pick(item) for item in ITEMS}
    for _ in range(10):  # bread that does not hide the plate below it
        if _cover(models["bread"], models["plate"]) < COVER:
            break
        models["bread"] = pick("bread")
    models["half"] = models["apple"].half or pick("apple_half")
    models["plate"] = soiled(models["plate"], rng, held_out=split == "held_out")
    models["gripper"] = pick("gripper")
    for fixture in ("table", "sink", "fridge", "tv", "tvstand", "counter", "wall_cabinet"):
        models[fixture] = pick(fixture)
    clutter = [kind for kind in distractors(split=split) if kind not in _AMBIGUOUS]
    loose = []
    for k in range(min(DISTRACTORS, 2 * len(clutter))):
        models[f"loose{k}"] = pick(clutter[int(rng.integers(len(clutter)))])
        loose.append(f"loose{k}")
    sizes = {name: model.extent for name, model in models.items()}
    layout = draw_layout(rng, split, sizes, hinge=hinge_side(models["fridge"]))
    files: dict[str, bytes] = {}
    assets: dict[str, None] = {}
    for model in models.values():
        files.update({_flat(name): content for name, content in model.files.items()})
        assets.update(dict.fromkeys(map(_flat_files, model.mjcf_assets())))
    bodies = [*_fixtures(layout, models), *_items(models)]
    bodies += [
        f'<body name="{name}" pos="0 0 -20">{models[name].mjcf_inside(name + "/")}</body>'
        for name in loose
    ]
    bodies += [
        f'<body name="{hand}" mocap="true" pos="0 0 -20">'
        f"{models['gripper'].mjcf_inside(hand + '/')}</body>"
        for hand in HANDS
    ]
    for use, texture_use in ROOM.items():
        for k in range(ROOM_CHOICE):
            texture = draw_texture(texture_use, rng, held_out=split == "held_out")
            files[f"{use}{k}.png"] = texture.png
            assets[
                f'<texture name="{use}{k}" type="2d" file="{use}{k}.png"/>'
                f'<material name="{use}{k}" texture="{use}{k}" texuniform="true"'
                f' texrepeat="{1 / texture.metres:.4g} {1 / texture.metres:.4g}"'
                f' specular="{0.5 * texture.shine:.3g}"/>'
            ] = None
    xml = _SCENE.format(
        size=size, assets="\n".join(assets), room=_room(layout), bodies="\n".join(bodies)
    )
    return Furniture(layout=layout, xml=xml, files=files, models=models, loose=tuple(loose))


def hinge_side(fridge: Model) -> float:
    """1 where the fridge's door hangs on its right, seen from the front; -1 on its left."""
    return 1.0 if fridge.joints[0].pos[0] > 0 else -1.0


def _cover(bread: Model, plate: Model) -> float:
    """Share of the plate that bread on it hides from above."""
    width, _, _ = plate.extent
    return 1.27 * min(bread.extent[0], width) * bread.extent[1] / width**2


def _flat(name: str) -> str:
    """A file name without folders, which MuJoCo ignores when it compares names."""
    return name.replace("/", "~")


def _flat_files(element: str) -> str:
    return re.sub(r'file="([^"]+)"', lambda found: f'file="{_flat(found[1])}"', element)


def _placed(name: str, stand: Stand, inside: str) -> str:
    return (
        f'<body name="{name}" pos="{stand.x:.4f} {stand.y:.4f} {stand.z:.4f}"'
        f' quat="{np.cos(stand.yaw / 2):.6f} 0 0 {np.sin(stand.yaw / 2):.6f}">{inside}</body>'
    )


def _fixtures(layout: Layout, models: Mapping[str, Model]) -> Iterable[str]:
    for k, stand in enumerate(layout.cabinets):
        yield _placed(f"counter{k}", stand, models["counter"].mjcf_inside(f"counter{k}/"))
    for k, stand in enumerate(layout.wall_cabinets):
        model = models["wall_cabinet"]
        yield _placed(f"upper{k}", stand, "\n".join(model.mjcf_geoms(f"upper{k}/")))
    for name, stand in (("sink", layout.sink), ("fridge", layout.fridge), ("table", layout.table)):
        yield _placed(name, stand, models[name].mjcf_inside(f"{name}/"))
    stand, height = layout.tv_stand, models["tvstand"].extent[2]
    yield _placed("tvstand", stand, models["tvstand"].mjcf_inside("tvstand/"))
    up = Stand(stand.x, stand.y, stand.yaw, height)
    yield _placed("tv", up, models["tv"].mjcf_inside("tv/"))


def _items(models: Mapping[str, Model]) -> Iterable[str]:
    for item in ITEMS:
        inside = models[item].mjcf_inside(f"{item}/")
        yield f'<body name="{item}" pos="0 0 -20"><freejoint name="{item}"/>{inside}</body>'
    for name in ("half_a", "half_b"):
        geoms = "\n".join(models["half"].mjcf_geoms(f"{name}/"))
        yield f'<body name="{name}" mocap="true" pos="0 0 -20">{geoms}</body>'


def _room(layout: Layout) -> str:
    w, d, h = layout.width / 2, layout.depth / 2, layout.height / 2
    walls = {
        "back": ((0, 0, h), "1 0 0 0 0 1", (w, h)),
        "front": ((0, -2 * d, h), "-1 0 0 0 0 1", (w, h)),
        "west": ((-w, -d, h), "0 1 0 0 0 1", (d, h)),
        "east": ((w, -d, h), "0 -1 0 0 0 1", (d, h)),
    }
    lines = [
        f'<geom name="floor" type="plane" pos="0 {-d} 0" size="{w} {d} 0.1" material="floor0"/>',
        f'<geom name="ceiling" type="plane" pos="0 {-d} {2 * h}" zaxis="0 0 -1"'
        f' size="{w} {d} 0.1" material="ceiling" contype="0" conaffinity="0"/>',
    ]
    for name, ((x, y, z), axes, (a, b)) in walls.items():
        lines.append(
            f'<geom name="wall_{name}" type="plane" pos="{x} {y} {z}" xyaxes="{axes}"'
            f' size="{a} {b} 0.1" material="wall0"/>'
        )
    run = [stand.x for stand in layout.cabinets if stand.yaw == 0]
    middle, half = (min(run) + max(run)) / 2, (max(run) - min(run)) / 2 + 0.3
    lines.append(
        f'<geom name="tiles" type="plane" pos="{middle} -0.004 1.17" xyaxes="1 0 0 0 0 1"'
        f' size="{half} 0.285 0.1" material="tiles0" contype="0" conaffinity="0"/>'
    )
    return "\n".join(lines)


_SCENE = """<mujoco model="kitchen">
<compiler angle="degree" boundmass="1e-4" boundinertia="1e-8" balanceinertia="true"/>
<option timestep="0.004" integrator="implicitfast"/>
<size memory="32M"/>
<statistic extent="4" center="0 -2 1"/>
<visual>
  <headlight ambient=".36 .36 .36" diffuse=".15 .15 .15" specular="0 0 0"/>
  <quality shadowsize="1024" offsamples="4"/>
  <map znear="0.01" zfar="4" shadowclip="3"/>
  <global offwidth="{size}" offheight="{size}"/>
</visual>
<asset>
<texture type="skybox" builtin="gradient" rgb1=".8 .85 .9" rgb2=".5 .55 .6" width="64" height="64"/>
<material name="ceiling" rgba=".95 .95 .95 1"/>
{assets}
</asset>
<worldbody>
<light name="ceiling" pos="0 -2 2.5" dir="0 0 -1" diffuse=".45 .44 .42" specular=".2 .2 .2"
  castshadow="true" cutoff="85" exponent="1" attenuation="1 0 0"/>
<light name="window" pos="-2 -3 2.3" dir=".5 .6 -.6" diffuse=".28 .29 .32" specular=".1 .1 .1"
  castshadow="false" cutoff="75" exponent="1"/>
<camera name="robot" pos="0 -2 1.4" fovy="60"/>
{room}
{bodies}
</worldbody>
</mujoco>"""
