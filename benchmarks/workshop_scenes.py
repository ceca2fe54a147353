"""Labelled pictures of a workshop: `python -m benchmarks.workshop_scenes FOLDER --count 100`.

A bench with a drawer, a vise and a toolbox, a lamp, a shelf, a hammer on a wall: seven facts, each
true in half of the pictures, by MuJoCo's renderer. Camera, light and what stands about differ in
every picture; with `--any` the workshop does, too: sizes, places, colours and textures of all.
The folder is one for `tpvqa train --pictures`, with the domain and its questions beside it.
"""

import argparse
import io
import os
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
from PIL import Image

os.environ.setdefault("MUJOCO_GL", "osmesa")

from tpvqa.chance import chance_array
from tpvqa.worlds.pictures import MANIFEST, Manifest, Picture, digest

WIDTH, HEIGHT = 320, 240
QUESTIONS = {
    "(lit lamp)": "Is the lamp on?",
    "(pulled drawer)": "Is the drawer open?",
    "(lifted toolbox)": "Is the toolbox open?",
    "(clamped part)": "Is the part in the vise?",
    "(stored crate)": "Is the crate on the shelf?",
    "(hung hammer)": "Is the hammer on the wall?",
    "(there barrel)": "Is there a barrel in the image?",
}
LEAST = {"(there barrel)": 400, "(lit lamp)": 12, "(hung hammer)": 25}
"""Pixels of a thing from which on a picture shows it; of others 40."""
_PREDICATES = ("lit", "pulled", "lifted", "clamped", "stored", "hung", "there")
_OBJECTS = ("lamp", "drawer", "toolbox", "part", "crate", "hammer", "barrel")
DOMAIN = f"""(define (domain workshop)
  (:requirements :strips)
  (:predicates {" ".join(f"({name} ?x)" for name in _PREDICATES)})
{
    "".join(
        f'''  (:action do-{name}
    :parameters (?x)
    :precondition (and)
    :effect ({name} ?x))
'''
        for name in _PREDICATES
    )
})
"""
PROBLEM = f"""(define (problem tidy)
  (:domain workshop)
  (:objects {" ".join(_OBJECTS)})
  (:init)
  (:goal (and {" ".join(QUESTIONS)})))
"""
Rng = np.random.Generator


def _said(*numbers: float) -> str:
    return " ".join(f"{number:.4f}" for number in numbers)


class _Workshop:
    """What stays as it is from picture to picture: sizes, places and colours."""

    def __init__(self, rng: Rng):
        def between(low: float, high: float) -> float:
            return float(rng.uniform(low, high))

        def paint() -> str:
            grey, vivid = rng.uniform(0.1, 0.9), rng.uniform(0, 0.8)
            return _said(*(grey + vivid * (rng.uniform(0.1, 0.9, 3) - grey)))

        def colour() -> str:
            return f"{paint()} 1"

        self.top = between(0.72, 0.9)
        self.half, self.deep = between(0.65, 0.85), between(0.28, 0.36)
        slots = rng.permutation(np.linspace(-0.45, 0.45, 3)) + rng.uniform(-0.05, 0.05, 3)
        self.vise, self.toolbox, self.lamp = (float(at) for at in slots)
        self.drawer = between(-0.35, 0.35)
        self.shelf = between(1.42, 1.6), float(rng.choice([-1, 1])) * between(0.25, 0.4)
        self.hook = -np.sign(self.shelf[1]) * between(0.2, 0.45), between(1.2, 1.4)
        names = "front drawer vise part toolbox lid lamp crate handle head shelf barrel"
        self.colours = {name: colour() for name in names.split()}
        kinds = ("checker", "gradient", "flat")
        self.textures = [
            f'<texture name="{name}" type="2d" builtin="{rng.choice(kinds)}" width="64" '
            f'height="64" rgb1="{paint()}" rgb2="{paint()}" mark="random" '
            f'random="{between(0, 0.04):.3f}" markrgb="{paint()}"/>'
            f'<material name="{name}" texture="{name}" texrepeat="{rng.integers(1, 9)} '
            f'{rng.integers(1, 9)}" specular="{between(0, 0.6):.2f}"/>'
            for name in ("wall", "floor", "bench")
        ]


def _geom(
    kind: str, at: tuple[float, ...], size: tuple[float, ...], rgba: str, more: str = ""
) -> str:
    return f'<geom type="{kind}" pos="{_said(*at)}" size="{_said(*size)}" rgba="{rgba}" {more}/>'


def _scene(shop: _Workshop, true: dict[str, bool], rng: Rng) -> str:
    """The workshop as MuJoCo reads it, with other clutter, light and camera at every call."""
    top, half, deep, hue = shop.top, shop.half, shop.deep, shop.colours
    parts = [
        '<geom type="plane" size="4 4 .1" material="floor"/>',
        f'<geom type="box" pos="0 {deep + 0.06:.3f} 1.2" size="3 .04 1.6" material="wall"/>',
        f'<geom type="box" pos="0 0 {top - 0.03:.3f}" size="{half:.3f} {deep:.3f} .03" '
        'material="bench"/>',
    ]
    leg = (0.04, deep - 0.03, top / 2 - 0.03)
    parts += [_geom("box", (x, 0, leg[2]), leg, hue["front"]) for x in (0.06 - half, half - 0.06)]
    # The drawer, in a case below the top.
    x, out = shop.drawer, float(rng.uniform(0.16, 0.26)) if true["(pulled drawer)"] else 0.0
    parts.append(_geom("box", (x, 0, top - 0.15), (0.24, deep - 0.02, 0.09), hue["front"]))
    front = -deep - 0.01 - out
    parts.append(
        _geom("box", (x, front, top - 0.15), (0.22, 0.012, 0.075), hue["drawer"], 'name="pulled"')
    )
    parts.append(
        _geom(
            "capsule",
            (x, front - 0.03, top - 0.15),
            (0.012, 0.06),
            "0.2 0.2 0.2 1",
            'euler="0 1.5708 0"',
        )
    )
    if out:
        parts.append(
            _geom("box", (x, front + out / 2, top - 0.21), (0.21, out / 2, 0.008), hue["drawer"])
        )
        middle, side = (front + out / 2, top - 0.16), (0.008, out / 2, 0.055)
        parts += [_geom("box", (x + at, *middle), side, hue["drawer"]) for at in (-0.21, 0.21)]
    # The vise, and the part in it or beside it.
    x, y = shop.vise, -deep + 0.12
    parts.append(_geom("box", (x, y, top + 0.03), (0.08, 0.05, 0.03), hue["vise"]))
    jaw = (0.018, 0.05, 0.045)
    parts += [_geom("box", (x + at, y, top + 0.1), jaw, hue["vise"]) for at in (-0.065, 0.065)]
    parts.append(
        _geom(
            "capsule",
            (x + 0.14, y, top + 0.06),
            (0.01, 0.06),
            "0.5 0.5 0.5 1",
            'euler="0 1.5708 0"',
        )
    )
    if true["(clamped part)"]:
        parts.append(
            _geom(
                "box",
                (x, y + float(rng.uniform(-0.02, 0.02)), top + 0.15),
                (0.045, 0.03, 0.09),
                hue["part"],
                'name="clamped"',
            )
        )
    else:
        aside = x + float(rng.choice([-1, 1])) * float(rng.uniform(0.17, 0.22))
        turn = f'euler="0 0 {rng.uniform(0, 3):.2f}" name="clamped"'
        parts.append(
            _geom("box", (aside, y + 0.05, top + 0.03), (0.09, 0.045, 0.03), hue["part"], turn)
        )
    # The toolbox, its lid shut or up.
    x, y = shop.toolbox, 0.05
    parts.append(_geom("box", (x, y, top + 0.06), (0.13, 0.08, 0.06), hue["toolbox"]))
    if true["(lifted toolbox)"]:
        tilt = float(rng.uniform(0.1, 0.5))
        parts.append(
            _geom(
                "box",
                (x, y + 0.09, top + 0.2),
                (0.13, 0.01, 0.08),
                hue["lid"],
                f'euler="{-tilt:.2f} 0 0" name="lifted"',
            )
        )
        parts.append(_geom("box", (x, y, top + 0.121), (0.115, 0.065, 0.002), "0.03 0.03 0.03 1"))
    else:
        parts.append(
            _geom("box", (x, y, top + 0.135), (0.135, 0.085, 0.015), hue["lid"], 'name="lifted"')
        )
        parts.append(_geom("box", (x, y, top + 0.165), (0.05, 0.012, 0.015), "0.2 0.2 0.2 1"))
    # The lamp: an arm, and a bulb that shines or does not.
    x, y = shop.lamp, 0.16
    lit = true["(lit lamp)"]
    parts.append(_geom("cylinder", (x, y, top + 0.01), (0.06, 0.01), hue["lamp"]))
    parts.append(_geom("capsule", (x, y, top + 0.18), (0.012, 0.16), hue["lamp"]))
    parts.append(_geom("cylinder", (x, y - 0.06, top + 0.36), (0.07, 0.035), hue["lamp"]))
    bulb = "1 0.97 0.75 1" if lit else "0.35 0.35 0.33 1"
    glow = 'name="lit" material="glow"' if lit else 'name="lit"'
    parts.append(_geom("sphere", (x, y - 0.08, top + 0.315), (0.045,), bulb, glow))
    if lit:
        parts.append(
            f'<light pos="{_said(x, y - 0.08, top + 0.26)}" dir="0 -0.2 -1" diffuse="0.7 0.65 0.5" '
            'cutoff="75" attenuation="1 0 1.5" castshadow="false"/>'
        )
    # Shelf and crate.
    high, x = shop.shelf
    parts.append(
        _geom(
            "box",
            (x, deep - 0.06, high),
            (0.3, 0.1, 0.012),
            hue["shelf"],
            "" if true["(stored crate)"] else 'name="stored"',
        )
    )
    crate = (x + float(rng.uniform(-0.12, 0.12)), deep - 0.08, high + 0.1)
    if not true["(stored crate)"]:
        crate = (float(rng.uniform(-0.3, 0.3)), -deep - float(rng.uniform(0.15, 0.35)), 0.1)
    named = 'name="stored"' if true["(stored crate)"] else ""
    parts.append(_geom("box", crate, (0.11, 0.075, 0.085), hue["crate"], named))
    slat = (0.112, 0.003, 0.012)
    parts += [
        _geom("box", (crate[0], crate[1] - 0.076, crate[2] + level), slat, "0.15 0.1 0.05 1")
        for level in (-0.04, 0.04)
    ]
    # The hammer, on the wall or on the bench.
    if true["(hung hammer)"]:
        x, z = shop.hook
        parts.append(_geom("capsule", (x, deep, z - 0.1), (0.014, 0.11), hue["handle"]))
        parts.append(
            _geom("box", (x, deep, z + 0.02), (0.065, 0.025, 0.025), hue["head"], 'name="hung"')
        )
    else:
        x, y = float(rng.uniform(-0.3, 0.3)), float(rng.uniform(-deep + 0.05, 0))
        round_about = float(rng.uniform(0, 3.1))
        parts.append(
            f'<body pos="{_said(x, y, top + 0.025)}" euler="0 0 {round_about:.2f}">'
            + _geom("capsule", (0, 0, 0), (0.014, 0.11), hue["handle"], 'euler="0 1.5708 0"')
            + _geom("box", (0.12, 0, 0), (0.025, 0.065, 0.025), hue["head"], 'name="hung"')
            + "</body>"
        )
    # The barrel, somewhere on the floor.
    if true["(there barrel)"]:
        x = float(rng.choice([-1, 1])) * float(rng.uniform(half - 0.1, half + 0.2))
        parts.append(
            _geom(
                "cylinder",
                (x, -deep - float(rng.uniform(0.1, 0.3)), 0.26),
                (0.17, 0.26),
                hue["barrel"],
                'name="there"',
            )
        )
    return _framed(shop, parts + _clutter(shop, rng), rng)


def _clutter(shop: _Workshop, rng: Rng) -> list[str]:
    """Cans, boxes and pipes of no meaning, on the bench's back and on the floor; pictures."""
    found = []
    for _ in range(int(rng.integers(2, 8))):
        rgba = _said(*rng.uniform(0.05, 0.95, 3), 1)
        high = float(rng.uniform(0.02, 0.08))
        size, kind = (
            float(rng.uniform(0.015, 0.045)),
            str(rng.choice(["box", "cylinder", "ellipsoid"])),
        )
        sizes = (size, high) if kind == "cylinder" else (size, size, high)
        x = float(rng.uniform(-shop.half + 0.05, shop.half - 0.05))
        if rng.random() < 0.7:
            at = (x, float(rng.uniform(0.0, shop.deep - 0.08)), shop.top + high)
        else:
            at = (1.3 * x, -shop.deep - float(rng.uniform(0, 0.5)), high)
        found.append(_geom(kind, at, sizes, rgba, f'euler="0 0 {rng.uniform(0, 3):.2f}"'))
    for _ in range(int(rng.integers(0, 3))):
        at = (float(rng.uniform(-1.2, 1.2)), shop.deep + 0.02, float(rng.uniform(1.2, 1.9)))
        sheet = (float(rng.uniform(0.05, 0.15)), 0.005, float(rng.uniform(0.05, 0.15)))
        found.append(_geom("box", at, sheet, _said(*rng.uniform(0.3, 1, 3), 1)))
    return found


def _framed(shop: _Workshop, parts: list[str], rng: Rng) -> str:
    aim = np.array([rng.uniform(-0.1, 0.1), 0.0, shop.top + rng.uniform(-0.02, 0.12)])
    around, above = rng.uniform(-0.5, 0.5), rng.uniform(0.1, 0.5)
    away = rng.uniform(1.9, 2.5)
    eye = aim + away * np.array(
        [np.sin(around) * np.cos(above), -np.cos(around) * np.cos(above), np.sin(above)]
    )
    back = (eye - aim) / np.linalg.norm(eye - aim)
    right = np.cross([0, 0, 1], back)
    right /= np.linalg.norm(right)
    up = np.cross(back, right)
    lights = []
    for _ in range(int(rng.integers(1, 3))):
        at = (rng.uniform(-2, 2), rng.uniform(-2.5, -0.5), rng.uniform(1.8, 3))
        tone = rng.uniform(0.25, 0.65) * rng.uniform(0.8, 1.0, 3)
        aside = -np.array(at) + np.array([0, 0, 0.8])
        lights.append(
            f'<light pos="{_said(*at)}" dir="{_said(*aside)}" diffuse="{_said(*tone)}" '
            f'castshadow="{"true" if rng.random() < 0.7 else "false"}"/>'
        )
    ambient = _said(*[rng.uniform(0.15, 0.4)] * 3)
    front, angle = _said(*[rng.uniform(0.05, 0.3)] * 3), rng.uniform(40, 50)
    return f"""<mujoco><compiler angle="radian"/>
<visual><headlight ambient="{ambient}" diffuse="{front}" specular="0 0 0"/>
<global offwidth="{WIDTH}" offheight="{HEIGHT}"/><quality shadowsize="1024"/></visual>
<asset>{"".join(shop.textures)}<material name="glow" emission="1"/></asset>
<worldbody>{"".join(parts)}{"".join(lights)}
<camera name="eye" pos="{_said(*eye)}" xyaxes="{_said(*right)} {_said(*up)}" fovy="{angle:.1f}"/>
</worldbody></mujoco>"""


def picture(
    number: int, *, anywhere: bool, seed: int = 0
) -> tuple[bytes, dict[str, bool], frozenset[str]]:
    """One picture as JPEG, what is true in it, and of which facts it shows enough.

    Args:
        number: Of the picture; decides all of it together with the seed.
        anywhere: Whether the workshop is another one, too.
        seed: Of all pictures.
    """
    import mujoco

    shop = _Workshop(chance_array(seed, number if anywhere else 0, "workshop", str(anywhere)))
    rng = chance_array(seed, number, "picture", str(anywhere))
    true = {fact: bool(rng.random() < 0.5) for fact in QUESTIONS}
    model = mujoco.MjModel.from_xml_string(_scene(shop, true, rng))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    with mujoco.Renderer(model, HEIGHT, WIDTH) as renderer:
        renderer.update_scene(data, camera="eye")
        pixels = renderer.render().astype(float)
        renderer.enable_segmentation_rendering()
        renderer.update_scene(data, camera="eye")
        drawn = np.bincount(renderer.render()[..., 0].ravel() + 1, minlength=model.ngeom + 1)[1:]
    gain = np.exp(rng.uniform(-0.35, 0.35)) * np.exp(rng.uniform(-0.08, 0.08, 3))
    noisy = pixels * gain + rng.normal(0, rng.uniform(0, 6), pixels.shape)
    file = io.BytesIO()
    image = Image.fromarray(np.clip(noisy, 0, 255).astype(np.uint8))
    image.save(file, "JPEG", quality=int(rng.integers(60, 95)))
    seen = {
        fact
        for fact, holds in true.items()
        if (fact == "(there barrel)" and not holds)
        or drawn[model.geom(fact[1:].split()[0]).id] >= LEAST.get(fact, 40)
    }
    return file.getvalue(), true, frozenset(seen)


def make(
    folder: Path,
    numbers: range,
    *,
    anywhere: bool,
    seed: int = 0,
    done: Callable[[int], None] = lambda _: None,
) -> None:
    """Fill a folder with pictures, their manifest, the domain, a problem and questions."""
    folder.mkdir(parents=True, exist_ok=True)
    told = []
    for number in numbers:
        data, true, seen = picture(number, anywhere=anywhere, seed=seed)
        file = f"{number:06d}.jpg"
        (folder / file).write_bytes(data)
        state = tuple(fact for fact, holds in true.items() if holds)
        told.append(Picture(file=file, sha256=digest(data), state=state, seen=seen))
        done(number)
    manifest = Manifest[Picture](domain="workshop", pictures=tuple(told))
    (folder / MANIFEST).write_text(manifest.model_dump_json(), encoding="utf-8")
    write_domain(folder)


def write_domain(folder: Path) -> None:
    """Write domain, problem and questions."""
    (folder / "domain.pddl").write_text(DOMAIN, encoding="utf-8")
    (folder / "problem.pddl").write_text(PROBLEM, encoding="utf-8")
    lines = [
        f'  {fact[1:].split()[0]}: "{text.replace(fact[1:-1].split()[1], "{x}")}"'
        for fact, text in QUESTIONS.items()
    ]
    (folder / "questions.yaml").write_text(
        "predicates:\n" + "\n".join(lines) + "\n", encoding="utf-8"
    )


def main() -> int:
    """Fill a folder."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--first", type=int, default=0, help="number of the first picture")
    parser.add_argument("--any", action="store_true", help="another workshop in every picture")
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    numbers = range(given.first, given.first + given.count)
    make(given.folder, numbers, anywhere=given.any, seed=given.seed)
    print(f"{given.count} pictures in {given.folder}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
