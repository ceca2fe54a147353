"""A domain, its questions and its world file → what does not fit, and what to do about it."""

from tpvqa.checking.check import check
from tpvqa.checking.finding import Finding, Severity

__all__ = ["Finding", "Severity", "check"]
