"""What users are told before anything runs."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tpvqa.belief.calibration import Calibration


def about_calibration(vlm: str, calibration: "Calibration | None") -> list[str]:
    """What to know of what a VLM's answers are taken to be worth.

    Args:
        vlm: Specification of the VLM.
        calibration: What the monitor is told; None for nothing.
    """
    notices = []
    if calibration is None and vlm != "oracle":  # which is always right
        notices.append(
            f"there is no calibration of {vlm}: its answers are taken to be right in 0.85. "
            f"Calibrated, it is asked less: `tpvqa calibrate --vlm {vlm} …`"
        )
    if calibration is not None and calibration.vlm not in ("", vlm):
        notices.append(f"the calibration was learnt of {calibration.vlm}, and this VLM is {vlm}")
    return notices
