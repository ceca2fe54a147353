"""The library of things: what a scene and the hold-out rely on."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tpvqa.errors import UnknownNameError
from tpvqa_household.kitchen.assets import (
    OFF,
    ON,
    Model,
    Split,
    attribution,
    dirt,
    distractors,
    draw,
    draw_texture,
    families,
    kinds,
    lookalikes,
    models,
    pack,
    soiled,
)
from tpvqa_household.kitchen.assets.families import FAMILIES
from tpvqa_household.kitchen.assets.family import Family
from tpvqa_household.kitchen.assets.library import LOOKALIKES, MAIN
from tpvqa_household.kitchen.assets.mesh import Floats, Mesh, cut, encode
from tpvqa_household.kitchen.assets.shapes import box, lathe, slab, tube

ROOT = Path(__file__).parents[3]
HANDLED = ("plate", "bread", "apple", "knife", "tv", "fridge", "sink", "gripper")
seeds = st.integers(0, 2**32)


def triangles(model: Model) -> int:
    """How many triangles a model has."""
    heads = [data[:16] for name, data in model.files.items() if name.endswith(".msh")]
    return sum(int(np.frombuffer(head, "<i4")[3]) for head in heads)


def points(model: Model) -> Floats:
    """All mesh points of a model's main body at their places, and the ends of its primitives."""
    found = []
    for part in model.parts:
        if part.mesh and part.euler == (0, 0, 0) and not part.body:
            data = model.files[part.mesh]
            n = int(np.frombuffer(data, "<i4", 1)[0])
            mesh = np.frombuffer(data, "<f4", 3 * n, 16).reshape(-1, 3)
            found.append(mesh * (part.size or (1, 1, 1)) + np.array(part.pos))
        elif not part.mesh and part.euler == (0, 0, 0) and not part.body:
            x, y, z = part.pos
            found.append(np.array([[x, y, z - part.size[-1]], [x, y, z + part.size[-1]]]))
    return np.concatenate(found)


def compiled(model: Model) -> Any:
    """The model alone in a scene, as MuJoCo compiles it."""
    mujoco = pytest.importorskip("mujoco")
    body = model.mjcf_inside("it_")
    xml = (
        f"<mujoco><asset>{''.join(model.mjcf_assets())}</asset>"
        f'<worldbody><body name="it">{body}</body></worldbody></mujoco>'
    )
    return mujoco.MjModel.from_xml_string(xml, assets=dict(model.files))


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.name)
def test_every_family_compiles_and_stands_on_its_origin(family: Family) -> None:
    model = next(m for m in models(family.kind) if m.family == family.name)
    compiled(model)
    assert triangles(model) <= 6500
    assert all("/" not in name for name in model.files)
    assert all(size > 0 for size in model.extent)
    assert model.licence
    if model.kind != "gripper":  # a gripper's origin lies between its finger tips
        cloud = points(model)
        assert abs(cloud[:, 2].min()) < 0.03
        span = cloud.max(axis=0) - cloud.min(axis=0)
        assert (span <= np.array(model.extent) * 1.25 + 0.03).all()


def test_two_models_and_the_same_model_twice_share_a_scene() -> None:
    mujoco = pytest.importorskip("mujoco")
    rng = np.random.default_rng(0)
    plate, bread = draw("plate", rng, split="train"), draw("bread", rng, split="train")
    assets = plate.mjcf_assets() + bread.mjcf_assets()
    bodies = [("a", plate), ("b", plate), ("c", bread)]
    xml = f"<mujoco><asset>{''.join(assets)}</asset><worldbody>" + "".join(
        f'<body name="{name}">{model.mjcf_inside(name + "_")}</body>' for name, model in bodies
    )
    scene = mujoco.MjModel.from_xml_string(
        xml + "</worldbody></mujoco>", assets={**plate.files, **bread.files}
    )
    first, second = (scene.geom(f"{name}_{plate.parts[0].name}") for name in "ab")
    assert first.dataid == second.dataid
    assert scene.geom(f"c_{bread.parts[0].name}").dataid != first.dataid


@given(seed=seeds, kind=st.sampled_from(HANDLED))
@settings(max_examples=25, deadline=None)
def test_a_draw_is_a_function_of_the_generator(seed: int, kind: str) -> None:
    first = draw(kind, np.random.default_rng(seed), split="train")
    second = draw(kind, np.random.default_rng(seed), split="train")
    assert first == second
    assert first.files == second.files


@given(seed=seeds, kind=st.sampled_from(HANDLED), held_out=st.booleans())
@settings(max_examples=40, deadline=None)
def test_a_draw_keeps_to_its_split(seed: int, kind: str, held_out: bool) -> None:
    split: Split = "held_out" if held_out else "train"
    model = draw(kind, np.random.default_rng(seed), split=split)
    assert model.kind == kind
    assert model.held_out == held_out
    assert model.family in {family.name for family in families(kind, split=split)}


def test_no_family_is_in_both_splits_and_every_handled_kind_has_both() -> None:
    names = [family.name for family in FAMILIES]
    assert len(names) == len(set(names))
    for kind in (*HANDLED, "apple_half", "table", "counter", "tvstand"):
        assert families(kind, split="train"), kind
        assert families(kind, split="held_out"), kind


def test_no_scanned_model_of_a_pack_is_in_both_splits() -> None:
    by_source: dict[tuple[str, str, str], set[bool]] = {}
    for entry in pack.index():
        key = (entry["pack"], entry["model"], entry["kind"])
        by_source.setdefault(key, set()).add(entry["held_out"])
    assert all(len(splits) == 1 for splits in by_source.values())


def test_styles_of_dirt_pictures_and_textures_are_split() -> None:
    from tpvqa_household.kitchen.assets import pictures, textures

    assert not set(dirt.styles(held_out=True)) & set(dirt.styles(held_out=False))
    assert not set(pictures.TRAIN) & set(pictures.HELD_OUT)
    assert len(pictures.TRAIN) + len(pictures.HELD_OUT) >= 12
    trained = {make for makers in textures.TRAIN.values() for make in makers}
    kept = {make for makers in textures.HELD_OUT.values() for make in makers}
    assert not trained & kept


@given(seed=seeds, held_out=st.booleans())
@settings(max_examples=15, deadline=None)
def test_dirt_lies_on_the_plate_and_covers_enough_of_it(seed: int, held_out: bool) -> None:
    rng = np.random.default_rng(seed)
    plate = draw("plate", rng, split="all")
    dirty = soiled(plate, rng, held_out=held_out)
    assert not plate.parts_with("dirt")
    patches = dirty.parts_with("dirt")
    assert patches
    radius = max(r for r, _ in plate.dish)
    covered = 0.0
    for part in patches:
        data = dirty.files[part.mesh or ""]
        n, _, _, m = np.frombuffer(data, "<i4", 4)
        cloud = np.frombuffer(data, "<f4", 3 * n, 16).reshape(-1, 3)
        assert np.hypot(cloud[:, 0], cloud[:, 1]).max() <= radius
        assert cloud[:, 2].min() > 0
        assert cloud[:, 2].max() < plate.extent[2] + 0.03
        corner = cloud[np.frombuffer(data, "<i4", 3 * m, 16 + 32 * n).reshape(-1, 3)]
        a, b = corner[:, 1, :2] - corner[:, 0, :2], corner[:, 2, :2] - corner[:, 0, :2]
        covered += np.clip(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], 0, None).sum() / 2
    assert covered > 0.08 * np.pi * radius**2


def test_dirt_needs_a_plate() -> None:
    rng = np.random.default_rng(0)
    with pytest.raises(ValueError, match="no plate"):
        soiled(draw("mug", rng, split="train"), rng, held_out=False)


@given(seed=seeds)
@settings(max_examples=10, deadline=None)
def test_an_apple_has_halves_of_its_own_skin(seed: int) -> None:
    apple = draw("apple", np.random.default_rng(seed), split="all")
    half = apple.half
    assert half is not None
    assert half.kind == "apple_half"
    assert half.held_out == apple.held_out
    assert half.parts_with("flesh")
    skins = [paint.texture for paint in apple.paints if paint.texture]
    own = next(paint for paint in half.paints if paint.name == "skin").texture
    assert any(half.files[own or ""] == apple.files[skin] for skin in skins)
    assert not set(half.files) & set(apple.files)


@pytest.mark.parametrize("model", models("tv"), ids=lambda model: model.name)
def test_a_tv_can_be_switched(model: Model) -> None:
    (screen,) = model.parts_with("screen")
    assert screen.paint == OFF
    looks = {paint.name: paint for paint in model.paints}
    assert max(looks[OFF].rgba[:3]) < 0.1
    assert looks[ON].texture in model.files


@pytest.mark.parametrize("model", models("fridge"), ids=lambda model: model.name)
def test_a_fridge_opens_outwards_and_has_shelves(model: Model) -> None:
    mujoco = pytest.importorskip("mujoco")
    scene = compiled(model)
    data = mujoco.MjData(scene)
    door = scene.joint("it_door_joint")
    assert door.range[0] == 0
    handle = scene.geom("it_handle").id
    mujoco.mj_forward(scene, data)
    shut = data.geom_xpos[handle].copy()
    data.qpos[door.qposadr] = np.radians(100)
    mujoco.mj_forward(scene, data)
    assert shut[1] < -0.2
    assert data.geom_xpos[handle][1] < shut[1] - 0.2
    shelves = [surface for surface in model.surfaces if surface.name.startswith("shelf")]
    assert len(shelves) >= 2
    x, y, z = model.extent
    for shelf in shelves:
        assert abs(shelf.pos[0]) + shelf.half[0] < x / 2
        assert abs(shelf.pos[1]) + shelf.half[1] < y / 2
        assert shelf.clearance > 0.12
        assert shelf.pos[2] + shelf.clearance < z + 0.05


@pytest.mark.parametrize("model", models("sink"), ids=lambda model: model.name)
def test_a_basin_is_sunk_and_open(model: Model) -> None:
    basin, top = model.surface("basin"), model.surface("top")
    assert 0.08 < top.pos[2] - basin.pos[2] < 0.35
    assert min(basin.half) > 0.1
    for solid in model.solids:  # nothing fills the space above the basin's floor
        low = [p - s for p, s in zip(solid.pos, solid.size, strict=True)]
        high = [p + s for p, s in zip(solid.pos, solid.size, strict=True)]
        above = high[2] > basin.pos[2] + 0.01
        over = all(low[k] < basin.pos[k] < high[k] for k in (0, 1))
        assert not (above and over)


@pytest.mark.parametrize("model", models("gripper"), ids=lambda model: model.name)
def test_fingers_meet_at_the_origin(model: Model) -> None:
    joints = {joint.body: joint for joint in model.joints}
    assert set(joints) == {"left", "right", "forearm"}
    assert joints["left"].axis == (0, 1, 0)
    assert joints["right"].axis == (0, -1, 0)
    for part in model.parts:
        if part.body in ("left", "right"):
            data = model.files[part.mesh or ""]
            n = int(np.frombuffer(data, "<i4", 1)[0])
            cloud = np.frombuffer(data, "<f4", 3 * n, 16).reshape(-1, 3)
            grip = cloud[cloud[:, 2] > -0.04]  # what holds things, not the root in the palm
            inner = grip[:, 1] * (1 if part.body == "left" else -1)
            assert inner.min() > -0.004
            assert 0 < cloud[:, 2].max() < 0.03


@pytest.mark.parametrize("kind", ["plate", "bread", "apple", "apple_half", "knife"])
def test_what_is_handled_can_be_grasped(kind: str) -> None:
    for model in models(kind):
        for grasp in model.grasps:
            assert np.isclose(np.linalg.norm(grasp.axis), 1)
            assert np.isclose(np.linalg.norm(grasp.approach), 1)
            assert np.isclose(np.dot(grasp.axis, grasp.approach), 0)
            assert all(abs(o) <= e for o, e in zip(grasp.offset, model.extent, strict=True))
        widths = [grasp.width for grasp in model.grasps]
        assert min(widths) > 0
        assert min(widths) <= 0.15  # as far as the grippers open


def test_furniture_cannot_be_grasped() -> None:
    with pytest.raises(ValueError, match="cannot be picked up"):
        _ = models("table")[0].grasp


def test_lookalikes_are_other_kinds_with_variants_in_their_split() -> None:
    assert set(LOOKALIKES) <= set(MAIN)
    for kind in LOOKALIKES:
        splits: tuple[Split, ...] = ("train", "held_out")
        for split in splits:
            found = lookalikes(kind, split=split)
            assert len(found) >= 2, (kind, split)
            assert set(found) <= set(distractors(split=split))
    assert len(distractors(split="train")) >= 12


def test_unknown_kinds_are_named_with_a_suggestion() -> None:
    with pytest.raises(UnknownNameError, match="Did you mean 'plate'"):
        draw("plaet", np.random.default_rng(0), split="train")
    with pytest.raises(UnknownNameError, match="held_out kind of thing 'teddy'"):
        draw("teddy", np.random.default_rng(0), split="held_out")
    with pytest.raises(UnknownNameError, match="use of a texture"):
        draw_texture("ceiling", np.random.default_rng(0), held_out=False)  # type: ignore[arg-type]


def test_kinds_are_listed_once() -> None:
    assert len(kinds()) == len(set(kinds()))
    assert set(MAIN) <= set(kinds())


@given(seed=seeds)
@settings(max_examples=10, deadline=None)
def test_textures_repeat_without_a_seam(seed: int) -> None:
    from io import BytesIO

    from PIL import Image

    texture = draw_texture("worktop", np.random.default_rng(seed), held_out=False)
    with Image.open(BytesIO(texture.png)) as image:
        pixels = np.asarray(image, float)
    assert max(pixels.shape[:2]) <= 256
    for axis in (0, 1):
        steps = np.abs(np.diff(pixels, axis=axis)).mean(axis=(1 - axis, 2))
        seam = np.abs(np.take(pixels, 0, axis) - np.take(pixels, -1, axis)).mean()
        assert seam <= 1.5 * steps.max() + 2


@pytest.mark.parametrize(
    "mesh",
    [
        box(0.2, 0.1, 0.3),
        box(0.2, 0.1, 0.3, bevel=0.01),
        lathe([(0, 0), (0.1, 0), (0.1, 0.2), (0, 0.2)]),
        tube(np.linspace([0, 0, 0], [0.3, 0, 0.1], 5), 0.02),
        slab(np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * 0.1, 0, 0.02, bevel=0.004),
    ],
    ids=["box", "bevelled box", "lathe", "tube", "slab"],
)
def test_shapes_are_closed_and_face_outwards(mesh: Mesh) -> None:
    corner = mesh.points[mesh.faces]
    cross = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    assert np.abs(cross.sum(axis=0)).max() < 1e-9  # closed: the areas cancel out
    assert np.einsum("ij,ij->i", corner[:, 0], cross).sum() > 0  # the volume is positive


def test_a_box_has_the_sizes_asked_for() -> None:
    mesh = box(0.2, 0.1, 0.3, bevel=0.01)
    assert np.allclose(mesh.high - mesh.low, [0.2, 0.1, 0.3])
    assert np.isclose(mesh.low[2], 0)


def test_cutting_keeps_what_lies_behind() -> None:
    half, rim = cut(box(0.2, 0.2, 0.2))
    assert half.high[1] <= 1e-9
    assert np.isclose(half.low[1], -0.1)
    assert np.allclose(rim[:, 1], 0)


def test_encoding_keeps_the_surface_and_gives_unit_normals() -> None:
    data = encode(lathe([(0, 0), (0.1, 0), (0.1, 0.2), (0, 0.2)], steps=16))
    n, n_normal, n_uv, _ = np.frombuffer(data, "<i4", 4)
    assert n == n_normal == n_uv
    normals = np.frombuffer(data, "<f4", 3 * n, 16 + 12 * n).reshape(-1, 3)
    assert np.allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-5)


def test_every_scanned_thing_is_credited() -> None:
    notice = (ROOT / "packages/tpvqa-household/NOTICE").read_text(encoding="utf-8")
    page = (ROOT / "docs" / "assets.md").read_text(encoding="utf-8")
    assert attribution.notice() in notice
    assert attribution.table() in page
    assert attribution.counts(FAMILIES) in page
    for entry in pack.index():
        assert entry["licence"] in attribution.LICENCES
        assert entry["creator"]
        assert entry["name"] in notice


def test_the_pack_holds_what_its_index_names_and_nothing_else() -> None:
    named = {"index.json"}
    for entry in pack.index():
        for part in entry["parts"]:
            named |= {part["mesh"]} | ({part["texture"]} if part["texture"] else set())
    archive = pack._archive()
    assert set(archive.namelist()) == named
    assert sum(info.compress_size for info in archive.infolist()) < 5e6
