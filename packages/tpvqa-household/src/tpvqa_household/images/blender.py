"""Blender's Cycles in a process of its own: scene files in, pictures out."""

import json
import os
import subprocess
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from tpvqa.errors import WorldError

SCRIPT = Path(__file__).with_name("cycles.py")
VARIABLE = "TPVQA_BLENDER_PYTHON"
REMEDY = (
    "Make an environment that has bpy (Python 3.11: `python3.11 -m venv blender && "
    "blender/bin/pip install bpy==5.0.1 numpy`) and name it with "
    f"`--blender-python blender/bin/python` or the variable {VARIABLE}; "
    "`--renderer mujoco` needs none of it"
)


def find_blender_python(named: Path | None = None) -> Path:
    """The Python that has Blender.

    Raises:
        WorldError: None is named, or the one named cannot import `bpy`.
    """
    path = named or (Path(os.environ[VARIABLE]) if os.environ.get(VARIABLE) else None)
    if path is None:
        raise WorldError(f"Rendering with Cycles needs a Python that has Blender. {REMEDY}")
    try:
        done = subprocess.run(
            [str(path), "-c", "import importlib.util as u; assert u.find_spec('bpy')"],
            capture_output=True,
            timeout=60,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise WorldError(f"{path} cannot be run ({error}). {REMEDY}") from error
    if done.returncode:
        raise WorldError(f"{path} has no module `bpy`. {REMEDY}")
    return path


class Cycles:
    """A running Blender that renders scene files.

    Args:
        python: A Python that has `bpy` and NumPy.
        size: Pixels along each side of what it renders.
        samples: Paths a pixel, before denoising.
        threads: CPU threads.
    """

    def __init__(self, python: Path, *, size: int = 256, samples: int = 8, threads: int = 1):
        self._folder = tempfile.TemporaryDirectory(prefix="tpvqa-cycles-")
        self._log = (Path(self._folder.name) / "blender.log").open("w+b")
        self._process = subprocess.Popen(
            [
                *(str(python), "-P", str(SCRIPT)),
                *("--size", str(size), "--samples", str(samples), "--threads", str(threads)),
            ],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._log,
            process_group=0,  # Ctrl-C ends it through `close`, not in the midst of a file
        )
        self._answer()

    def render(self, arrays: dict[str, Any]) -> NDArray[np.uint8]:
        """Render a scene, as `scene_file.scene_arrays` describes it.

        Raises:
            WorldError: Blender ended or could not render it.
        """
        folder = Path(self._folder.name)
        scene, out = folder / "scene.npz", folder / "picture.png"
        with scene.open("wb") as file:
            np.savez(file, **arrays)
        job = json.dumps({"scene": str(scene), "out": str(out)}) + "\n"
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(job.encode())
            self._process.stdin.flush()
        except OSError as error:
            raise WorldError(f"Blender ended: {self._said()}") from error
        answer = self._answer()
        if "error" in answer:
            raise WorldError(f"Blender could not render a scene: {answer['error']}")
        with Image.open(out) as picture:
            return np.asarray(picture.convert("RGB"))

    def close(self) -> None:
        """End the process and remove its files. Can be called twice."""
        if self._process.poll() is None:
            assert self._process.stdin is not None
            self._process.stdin.close()
            try:
                self._process.wait(timeout=2)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        if self._process.stdout is not None:
            self._process.stdout.close()
        self._log.close()
        self._folder.cleanup()

    def _answer(self) -> dict[str, Any]:
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if not line:
            raise WorldError(f"Blender ended: {self._said()}. {REMEDY}")
        answer: dict[str, Any] = json.loads(line)
        return answer

    def _said(self) -> str:
        self._process.wait(timeout=10)
        self._log.seek(0)
        said = self._log.read().decode(errors="replace").strip().splitlines()
        return (said[-1] if said else "") + f" (exit code {self._process.returncode})"
