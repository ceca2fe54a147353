"""What a trial is, in names and numbers: one model that CLI, YAML, log and bench read."""

from tpvqa.config.model import (
    Limits,
    MonitorConfig,
    PlannerConfig,
    SimulationConfig,
    StartConfig,
    TaskConfig,
    TrialConfig,
    WorldConfig,
)
from tpvqa.config.parts import VLMConfig

__all__ = [
    "Limits",
    "MonitorConfig",
    "PlannerConfig",
    "SimulationConfig",
    "StartConfig",
    "TaskConfig",
    "TrialConfig",
    "VLMConfig",
    "WorldConfig",
]
