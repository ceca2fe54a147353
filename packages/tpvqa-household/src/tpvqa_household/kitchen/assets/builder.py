"""Putting a model together, part by part."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from tpvqa_household.kitchen.assets.mesh import Mesh, encode
from tpvqa_household.kitchen.assets.model import (
    Grasp,
    Joint,
    Model,
    Paint,
    Part,
    Rgba,
    Shape,
    Solid,
    Surface,
    Vec,
)

ORIGIN: Vec = (0.0, 0.0, 0.0)


@dataclass(slots=True)
class Builder:
    """Collects the parts of one model. Sizes are those of `Model`."""

    paints: list[Paint] = field(default_factory=list)
    parts: list[Part] = field(default_factory=list)
    solids: list[Solid] = field(default_factory=list)
    joints: list[Joint] = field(default_factory=list)
    surfaces: list[Surface] = field(default_factory=list)
    files: dict[str, bytes] = field(default_factory=dict)

    def paint(
        self,
        name: str,
        colour: tuple[float, float, float] | Rgba = (1.0, 1.0, 1.0),
        *,
        texture: bytes | None = None,
        specular: float = 0.2,
        shininess: float = 0.3,
        emission: float = 0.0,
        reflectance: float = 0.0,
    ) -> str:
        """A new material; gives its name back."""
        file = None
        if texture is not None:
            file = f"~{name}.png"
            self.files[file] = texture
        r, g, b, *rest = (float(value) for value in colour)
        self.paints.append(
            Paint(
                name=name,
                rgba=(r, g, b, rest[0] if rest else 1.0),
                texture=file,
                specular=float(specular),
                shininess=float(shininess),
                emission=float(emission),
                reflectance=float(reflectance),
            )
        )
        return name

    def encoded(
        self, name: str, data: bytes, paint: str, *, scale: float = 1.0, role: str = ""
    ) -> None:
        """A mesh that is already in MuJoCo's format as a part."""
        file = f"~{name}.msh"
        self.files[file] = data
        size = () if scale == 1 else (scale, scale, scale)
        self.parts.append(
            Part(name=name, paint=paint, shape="mesh", mesh=file, size=size, role=role)
        )

    def mesh(
        self,
        name: str,
        mesh: Mesh,
        paint: str,
        *,
        pos: Vec = ORIGIN,
        euler: Vec = ORIGIN,
        body: str = "",
        role: str = "",
        crease: float = 40.0,
    ) -> None:
        """A mesh as a part."""
        file = f"~{name}.msh"
        self.files[file] = encode(mesh, crease=crease)
        self.parts.append(
            Part(
                name=name,
                paint=paint,
                shape="mesh",
                mesh=file,
                pos=pos,
                euler=euler,
                body=body,
                role=role,
            )
        )

    def shape(
        self,
        name: str,
        shape: Shape,
        size: tuple[float, ...],
        paint: str,
        *,
        pos: Vec = ORIGIN,
        euler: Vec = ORIGIN,
        body: str = "",
        role: str = "",
    ) -> None:
        """A primitive as a part."""
        self.parts.append(
            Part(
                name=name,
                paint=paint,
                shape=shape,
                size=tuple(float(value) for value in size),
                pos=pos,
                euler=euler,
                body=body,
                role=role,
            )
        )

    def solid(
        self,
        shape: Shape,
        size: tuple[float, ...],
        pos: Vec,
        *,
        euler: Vec = ORIGIN,
        body: str = "",
    ) -> None:
        """Something that physics sees."""
        self.solids.append(
            Solid(
                shape=shape,
                size=tuple(float(value) for value in size),
                pos=(float(pos[0]), float(pos[1]), float(pos[2])),
                euler=euler,
                body=body,
            )
        )

    def standing(self, shape: Shape, extent: Vec) -> None:
        """One box or upright cylinder around the whole thing."""
        x, y, z = extent
        size = (x / 2, y / 2, z / 2) if shape == "box" else (max(x, y) / 2, z / 2)
        self.solid(shape, size, (0.0, 0.0, z / 2))

    def top(self, name: str, pos: Vec, half: tuple[float, float], clearance: float = 1.0) -> None:
        """A surface on which things can stand."""
        self.surfaces.append(
            Surface(
                name=name,
                pos=(float(pos[0]), float(pos[1]), float(pos[2])),
                half=(float(half[0]), float(half[1])),
                clearance=float(clearance),
            )
        )

    def done(
        self,
        kind: str,
        extent: Vec,
        mass: float,
        *,
        grasps: tuple[Grasp, ...] = (),
        colour: tuple[float, float, float] = (0.5, 0.5, 0.5),
        dish: Sequence[tuple[float, float]] = (),
        half: Model | None = None,
        creator: str = "",
        licence: str = "Apache-2.0",
        pack: str = "",
    ) -> Model:
        """The finished model; its name and family are given by the library."""
        return Model(
            kind=kind,
            name="",
            family="",
            held_out=False,
            extent=(float(extent[0]), float(extent[1]), float(extent[2])),
            paints=tuple(self.paints),
            parts=tuple(self.parts),
            solids=tuple(self.solids),
            mass=float(mass),
            files=dict(self.files),
            joints=tuple(self.joints),
            surfaces=tuple(self.surfaces),
            grasps=grasps,
            colour=(float(colour[0]), float(colour[1]), float(colour[2])),
            dish=tuple((float(r), float(z)) for r, z in dish),
            half=half,
            creator=creator,
            licence=licence,
            pack=pack,
        )
