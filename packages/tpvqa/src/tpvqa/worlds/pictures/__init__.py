"""A world seen in labelled pictures: for any domain, without a renderer."""

from tpvqa.worlds.pictures.manifest import MANIFEST, Manifest, Picture, digest, media_type
from tpvqa.worlds.pictures.picture_set import PictureSet, load_set
from tpvqa.worlds.pictures.world import VIEW, PictureWorld

__all__ = [
    "MANIFEST",
    "VIEW",
    "Manifest",
    "Picture",
    "PictureSet",
    "PictureWorld",
    "digest",
    "load_set",
    "media_type",
]
