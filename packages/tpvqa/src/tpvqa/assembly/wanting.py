"""What is said of a setting that neither world, monitor nor VLM takes: for what it is."""

from collections.abc import Collection, Mapping
from typing import TYPE_CHECKING, Any

from tpvqa.config.layers import settings
from tpvqa.errors import shown
from tpvqa.plugins import see_taken

if TYPE_CHECKING:
    from tpvqa.assembly import Trial

_FOR = {
    "pictures": ("world", "pictures:FOLDER, or for --world images"),
    "simulator": ("world", "images"),
    "majority": ("monitor", "tpvqa, or for --monitor vote:K"),
    "no_alternatives": ("monitor", "tpvqa"),
}
"""Settings that plug-ins of one kind take; those of VLMs begin with what they are for."""


def see_wanted(
    trial: "Trial",
    options: Mapping[str, Any],
    taken: Collection[str],
    context: Collection[str],
) -> None:
    """See that every setting is one that world, monitor or VLM took.

    Args:
        trial: The trial.
        options: The settings that plug-ins may ask for.
        taken: The names of what they took.
        context: All that they could have had.

    Raises:
        PluginError: A setting for others is not taken.
        UnknownNameError: Another is not.
    """
    see_taken(
        options,
        taken,
        context,
        whose="this world, monitor and VLM",
        wanting=_wanting(trial),
    )


def _wanting(trial: "Trial") -> dict[str, str]:
    """What is said of settings that are for other plug-ins, by their names."""
    taken = {
        "world": trial.world_spec,
        "monitor": trial.config.monitor.named,
        "vlm": trial.vlm_spec,
    }
    found = {}
    for each in settings():
        kind, colon, _ = each.says.partition(":")
        name = each.option.removeprefix("--").replace("-", "_")
        if colon and kind in ("openai", "hf"):
            what, example = "vlm", f"{kind}:MODEL"
        elif name in _FOR:
            what, example = _FOR[name]
        else:
            continue
        called = "VLM" if what == "vlm" else what
        found[name] = (
            f"{each.option} is for --{what} {example}, and this {called} is {shown(taken[what])}. "
            f"Leave it out, or take such a {called}."
        )
    return found
