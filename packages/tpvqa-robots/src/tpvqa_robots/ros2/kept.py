"""A simulated world that outlives its process: a robot's table stays when its server is killed."""

import json
from pathlib import Path
from typing import Any

from tpvqa.errors import WorldError
from tpvqa.files import read_plain, write_whole
from tpvqa.worlds import Restorable, World


class Kept:
    """Keeps a world's state in a file, and puts it back.

    Args:
        world: The world.
        file: The file; where it is there, the world is put into its state.

    Raises:
        WorldError: The world cannot be put back, or the file is not of this world.
    """

    def __init__(self, world: World, file: Path):
        if not isinstance(world, Restorable):
            raise WorldError("This world cannot be put back: leave out --keep.")
        self._world, self._file = world, file
        if file.exists():
            self._restore()

    def keep(self) -> None:
        """Write the world's state down.

        Raises:
            WriteError: It cannot be written.
        """
        data = json.dumps(dict(self._world.snapshot())).encode()
        write_whole(self._file, data, remedy="Name another file with --keep")

    def _restore(self) -> None:
        try:
            snapshot: Any = json.loads(read_plain(self._file))
            self._world.restore(snapshot)
        except Exception as error:
            raise WorldError(
                f"{self._file} is not the state of this world ({type(error).__name__}: {error}). "
                "Remove it to begin anew, or name another file with --keep."
            ) from error
