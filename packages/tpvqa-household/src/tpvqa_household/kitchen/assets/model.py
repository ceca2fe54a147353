"""What a thing in the kitchen looks like, and how MuJoCo is told.

A `Model` is one variant of one kind of thing: drawable parts, solids for physics, joints, where
things can stand on it, how a parallel gripper holds it, and the bytes of its meshes and textures.
Metres throughout; the origin is at the centre of the bottom, z points up, the front faces -y and
whatever is long (bread, knife, spoon) lies along x.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import cos, radians, sin
from typing import Literal

Vec = tuple[float, float, float]
Rgba = tuple[float, float, float, float]
Shape = Literal["mesh", "box", "cylinder", "sphere", "capsule", "ellipsoid"]


def _numbers(*values: float) -> str:
    return " ".join(f"{value:.6g}" for value in values)


def quaternion(euler: Vec) -> tuple[float, float, float, float]:
    """The rotation that turns about x, then the new y, then the new z, by degrees."""
    w, x, y, z = 1.0, 0.0, 0.0, 0.0
    for axis, angle in enumerate(euler):
        c, s = cos(radians(angle) / 2), sin(radians(angle) / 2)
        a, b, d = (s if i == axis else 0.0 for i in range(3))
        w, x, y, z = (
            w * c - x * a - y * b - z * d,
            w * a + x * c + y * d - z * b,
            w * b + y * c + z * a - x * d,
            w * d + z * c + x * b - y * a,
        )
    return w, x, y, z


@dataclass(frozen=True, slots=True)
class Paint:
    """A material. `texture` is the name of a PNG among the model's files."""

    name: str
    rgba: Rgba
    texture: str | None = None
    specular: float = 0.2
    shininess: float = 0.3
    emission: float = 0.0
    reflectance: float = 0.0


@dataclass(frozen=True, slots=True)
class Part:
    """One drawable piece: a mesh or a primitive shape in MuJoCo's sense.

    Attributes:
        name: Unique in the model.
        paint: Name of its material.
        shape: A MuJoCo geom type.
        mesh: Name of the mesh among the model's files, for the shape "mesh".
        size: Half sizes as MuJoCo wants them, for primitives; scale factors for meshes.
        pos: Place in its body.
        euler: Turn in its body, degrees about x, y, z (intrinsic).
        body: Which of the model's bodies it belongs to; "" is the main one.
        role: What the scene may want to find it by, e.g. "screen", "dirt", "flesh", "skin".
    """

    name: str
    paint: str
    shape: Shape
    mesh: str | None = None
    size: tuple[float, ...] = ()
    pos: Vec = (0.0, 0.0, 0.0)
    euler: Vec = (0.0, 0.0, 0.0)
    body: str = ""
    role: str = ""


@dataclass(frozen=True, slots=True)
class Solid:
    """A primitive that physics sees. `size` as MuJoCo wants it (half sizes)."""

    shape: Shape
    size: tuple[float, ...]
    pos: Vec
    euler: Vec = (0.0, 0.0, 0.0)
    body: str = ""


@dataclass(frozen=True, slots=True)
class Joint:
    """A body that moves against the main one: a fridge's door, a gripper's finger.

    Attributes:
        body: Its name.
        kind: "hinge", "slide" or "ball" (turns freely).
        pos: Where the body's own frame (and the axis) stands in the main body.
        axis: Direction of the axis; positive values open.
        range: Degrees (hinge) or metres (slide).
    """

    body: str
    kind: Literal["hinge", "slide", "ball"]
    pos: Vec
    axis: Vec
    range: tuple[float, float]


@dataclass(frozen=True, slots=True)
class Surface:
    """A level rectangle on which things can stand.

    Attributes:
        name: "top", "basin", "shelf0", …
        pos: Its centre.
        half: Half sizes along x and y.
        clearance: Free height above it.
    """

    name: str
    pos: Vec
    half: tuple[float, float]
    clearance: float = 1.0


@dataclass(frozen=True, slots=True)
class Grasp:
    """How a parallel gripper holds the thing.

    Attributes:
        offset: The point between the finger tips.
        axis: The direction in which the fingers close.
        approach: The direction in which the fingers point.
        width: How far the fingers are apart when they hold it.
    """

    offset: Vec
    axis: Vec
    approach: Vec
    width: float


@dataclass(frozen=True)
class Model:
    """One variant of one kind of thing.

    Attributes:
        kind: What it is: "plate", "bread", …
        name: Stable id; also the prefix of the names of its meshes, textures and materials.
        family: What it is a variant of; families are either trained on or held out, never both.
        held_out: True if training must not show it.
        extent: Sizes along x, y and z.
        paints: Its materials.
        parts: What is drawn.
        solids: What physics sees.
        mass: In kilograms, for the sum of the solids.
        files: Bytes of the meshes and textures by name, for `MjModel.from_xml_string(assets=…)`.
            No name has a slash: MuJoCo looks only at what follows the last one.
        joints: Bodies that move.
        surfaces: Where things can stand.
        grasps: Ways of holding it, the preferred one first; none for what stays where it is.
        creator: Who made it; empty for this project's own shapes.
        licence: Short name of the licence.
        pack: The collection that it comes from.
        colour: The colour that it mainly has.
        dish: For plates, the upper side as (radius, height) points from the middle outwards.
        half: For an apple, one of its two equal halves, lying on its back with the flesh up.
    """

    kind: str
    name: str
    family: str
    held_out: bool
    extent: Vec
    paints: tuple[Paint, ...]
    parts: tuple[Part, ...]
    solids: tuple[Solid, ...]
    mass: float
    files: Mapping[str, bytes] = field(repr=False)
    joints: tuple[Joint, ...] = ()
    surfaces: tuple[Surface, ...] = ()
    grasps: tuple[Grasp, ...] = ()
    creator: str = ""
    licence: str = "Apache-2.0"
    pack: str = ""
    colour: tuple[float, float, float] = (0.5, 0.5, 0.5)
    dish: tuple[tuple[float, float], ...] = ()
    half: "Model | None" = field(default=None, repr=False)

    @property
    def grasp(self) -> Grasp:
        """The preferred way of holding it.

        Raises:
            ValueError: It cannot be picked up.
        """
        if not self.grasps:
            raise ValueError(f"{self.name} cannot be picked up")
        return self.grasps[0]

    def material(self, paint: str) -> str:
        """The name under which a paint is known to MuJoCo."""
        return f"{self.name}/{paint}"

    def mjcf_assets(self) -> list[str]:
        """The elements for `<asset>`: once for each model in a scene, however often it stands."""
        lines = [
            f'<texture name="{texture}" type="2d" file="{texture}"/>'
            for texture in dict.fromkeys(p.texture for p in self.paints if p.texture)
        ]
        for paint in self.paints:
            texture = f' texture="{paint.texture}"' if paint.texture else ""
            lines.append(
                f'<material name="{self.material(paint.name)}"{texture}'
                f' rgba="{_numbers(*paint.rgba)}" specular="{paint.specular:.3g}"'
                f' shininess="{paint.shininess:.3g}" emission="{paint.emission:.3g}"'
                f' reflectance="{paint.reflectance:.3g}"/>'
            )
        meshes = dict.fromkeys((p.mesh, p.size) for p in self.parts if p.mesh)
        for mesh, scale in meshes:
            grown = f' scale="{_numbers(*scale)}"' if scale else ""
            lines.append(
                f'<mesh name="{_mesh_name(mesh, scale)}" file="{mesh}" inertia="shell"{grown}/>'
            )
        return lines

    def mjcf_geoms(self, prefix: str, *, body: str = "") -> list[str]:
        """The drawn geoms of one of its bodies, named `prefix` + the part's name.

        They are in group 1, touch nothing and weigh nothing.
        """
        lines = []
        for part in self.parts:
            if part.body != body:
                continue
            look = (
                f'mesh="{_mesh_name(part.mesh, part.size)}"'
                if part.mesh
                else f'size="{_numbers(*part.size)}"'
            )
            lines.append(
                f'<geom name="{prefix}{part.name}" type="{part.shape}" {look}'
                f' material="{self.material(part.paint)}" pos="{_numbers(*part.pos)}"'
                f' quat="{_numbers(*quaternion(part.euler))}"'
                ' contype="0" conaffinity="0" group="1" mass="0"/>'
            )
        return lines

    def mjcf_solids(self, prefix: str, *, body: str = "") -> list[str]:
        """The unseen geoms (group 3) that physics sees, named `prefix` + "solid0", "solid1", …

        The mass is shared among them evenly by volume.
        """
        volumes = [_volume(solid) for solid in self.solids]
        lines = []
        for index, (solid, volume) in enumerate(zip(self.solids, volumes, strict=True)):
            if solid.body == body:
                lines.append(
                    f'<geom name="{prefix}solid{index}" type="{solid.shape}"'
                    f' size="{_numbers(*solid.size)}" pos="{_numbers(*solid.pos)}"'
                    f' quat="{_numbers(*quaternion(solid.euler))}"'
                    f' mass="{self.mass * volume / sum(volumes):.4g}" group="3"'
                    ' rgba="1 0 0 0.3" friction="1 0.05 0.01" condim="4"/>'
                )
        return lines

    def mjcf_bodies(self, prefix: str, *, jointed: bool = True) -> list[str]:
        """Its moving bodies (named `prefix` + body), each with joint, geoms and solids.

        The joint is named `prefix` + body + "_joint". Ranges are in degrees, so the scene's
        `<compiler angle="degree"/>` (the default) has to stay.

        Args:
            prefix: For all names.
            jointed: False leaves the joints out, for a scene that poses the bodies itself.
        """
        lines = []
        for joint in self.joints:
            inside = self.mjcf_geoms(prefix, body=joint.body)
            solids = self.mjcf_solids(prefix, body=joint.body)
            inside += solids or ['<inertial pos="0 0 0" mass="0.1" diaginertia="1e-4 1e-4 1e-4"/>']
            if jointed:
                inside.insert(0, _joint(joint, f"{prefix}{joint.body}_joint"))
            lines.append(
                f'<body name="{prefix}{joint.body}" pos="{_numbers(*joint.pos)}">'
                + "".join(inside)
                + "</body>"
            )
        return lines

    def mjcf_inside(self, prefix: str, *, jointed: bool = True) -> str:
        """Everything for the inside of a `<body>`: drawn geoms, solids and moving bodies."""
        return "\n".join(
            self.mjcf_geoms(prefix)
            + self.mjcf_solids(prefix)
            + self.mjcf_bodies(prefix, jointed=jointed)
        )

    def parts_with(self, role: str) -> tuple[Part, ...]:
        """The parts that play a role, e.g. the "screen" of a TV."""
        return tuple(part for part in self.parts if part.role == role)

    def surface(self, name: str) -> Surface:
        """The surface of that name.

        Raises:
            KeyError: It has none of that name.
        """
        for surface in self.surfaces:
            if surface.name == name:
                return surface
        raise KeyError(f"{self.name} has no surface {name!r}")

    def named(self, name: str) -> "Model":
        """The same thing under another name, so that two of it can differ in one scene."""
        new = {old: name + old.removeprefix(self.name) for old in self.files}
        return replace(
            self,
            name=name,
            paints=tuple(
                replace(p, texture=new[p.texture] if p.texture else None) for p in self.paints
            ),
            parts=tuple(replace(p, mesh=new[p.mesh] if p.mesh else None) for p in self.parts),
            files={new[old]: data for old, data in self.files.items()},
            half=self.half.named(f"{name}-half") if self.half else None,
        )


def _joint(joint: Joint, name: str) -> str:
    if joint.kind == "ball":
        return f'<joint name="{name}" type="ball" damping="2"/>'
    return (
        f'<joint name="{name}" type="{joint.kind}" axis="{_numbers(*joint.axis)}"'
        f' range="{_numbers(*joint.range)}" limited="true" damping="2" frictionloss="0.5"/>'
    )


def _mesh_name(mesh: str | None, scale: tuple[float, ...]) -> str:
    if not scale:
        return mesh or ""
    return f"{mesh}@" + "x".join(f"{factor:.4g}" for factor in scale)


def _volume(solid: Solid) -> float:
    size = solid.size
    if solid.shape == "box":
        return 8 * size[0] * size[1] * size[2]
    if solid.shape in ("cylinder", "capsule"):
        return 6.28 * size[0] ** 2 * size[1]
    return 4.19 * size[0] ** 3
