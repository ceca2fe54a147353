"""How to train: every number that decides the result."""

import tomllib
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

from tpvqa.errors import TpvqaError

DEFAULT = Path(__file__).with_name("recipe.toml")


@dataclass(frozen=True, slots=True)
class Recipe:
    """The settings of a training run; `recipe.toml` says what each is."""

    seed: int
    task: str
    steps: int
    batch: int
    per_share: int
    warm_up: int
    frozen_blocks: int
    width: int
    head_rate: float
    backbone_rate: float
    weight_decay: float
    smoothing: float
    average: float
    validation_from: int

    @classmethod
    def read(cls, path: Path = DEFAULT, **changes: Any) -> "Recipe":
        """Read a recipe file.

        Args:
            path: A TOML file that names every setting.
            changes: Settings that replace the file's; None leaves it.

        Raises:
            TpvqaError: The file is missing, is not TOML, or names other settings.
        """
        try:
            found = tomllib.loads(path.read_text(encoding="utf-8"))
        except OSError as error:
            raise TpvqaError(f"{path}: cannot be read ({error.strerror}).") from None
        except tomllib.TOMLDecodeError as error:
            raise TpvqaError(f"{path}: not a TOML file: {error}.") from None
        names = {field.name for field in fields(cls)}
        if names != set(found):
            wrong = ", ".join(sorted(names ^ set(found)))
            raise TpvqaError(f"{path}: settings missing or not known: {wrong}.")
        given = {name: value for name, value in changes.items() if value is not None}
        return replace(cls(**found), **given)
