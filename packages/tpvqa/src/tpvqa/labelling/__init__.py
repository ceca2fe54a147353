"""Labelling recorded episodes: what to ask a person next, and what their labels teach."""

from tpvqa.episodes.own_files import LABELS
from tpvqa.labelling.labels import Label, Labels, read_labels
from tpvqa.labelling.recorded import Asking, Given, RecordedEpisode, check_apart, read_recorded
from tpvqa.labelling.session import Session

__all__ = [
    "LABELS",
    "Asking",
    "Given",
    "Label",
    "Labels",
    "RecordedEpisode",
    "Session",
    "check_apart",
    "read_labels",
    "read_recorded",
]
