"""What a trial has where nothing is named: its world and its VLM."""

from tpvqa.distributions import HOUSEHOLD, how_to_install
from tpvqa.errors import PluginError
from tpvqa.plugins import Kind, load_spec, names
from tpvqa.tasks import TaskFiles
from tpvqa.vlm.capabilities import is_noise_model

SYMBOLIC = "symbolic"
ORACLE = "oracle"
EMBEDDED = "embedded"
"""The network that the household brings."""
SURVEY = "survey:8:twice"
"""Who asks noise models that a calibration is learnt of: it asks regardless of the answers, so that
all of them count, and gets on where answers are worth little."""


def default_world(files: TaskFiles | None, vlm: str | None = None) -> str:
    """Specification of the world: a shipped task's own, but symbolic for noise models.

    Args:
        files: The shipped task; None for a user's own domain, which is run in the symbolic world.
        vlm: Specification of the VLM, where it decides.
    """
    if files is None or (vlm is not None and not looks(vlm)):
        return SYMBOLIC
    return files.default_world


def looks(vlm: str) -> bool:
    """Whether a VLM looks at pictures; noise models do not."""
    return not is_noise_model(load_spec(Kind.VLM, vlm))


def default_vlm(files: TaskFiles | None = None, *, pictures: bool = True) -> str:
    """Specification of the VLM: the oracle without pictures, else a shipped task's own, else the
    embedded network.

    Args:
        files: The shipped task; None for a user's own domain.
        pictures: Whether the world has pictures.

    Raises:
        PluginError: There are pictures, and the embedded network is not installed.
    """
    if not pictures:
        return ORACLE
    if files is not None and files.default_vlm:
        return files.default_vlm
    if EMBEDDED not in names(Kind.VLM):
        raise PluginError(
            "No VLM is named that looks at the pictures. Name one, e.g. --vlm openai:MODEL, or "
            f"install the embedded network: {how_to_install(HOUSEHOLD)}."
        )
    return EMBEDDED


def labelling_monitor(vlm: str) -> str:
    """Specification of the monitor of trials that a calibration is learnt from: a survey of noise
    models; of VLMs that look, whose every answer costs, `tpvqa`."""
    return "tpvqa" if looks(vlm) else SURVEY
