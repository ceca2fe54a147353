"""What others wrote, as JSON: read strictly, and without listing all that is wrong with it."""

from tpvqa.told.models import ToldModel, first_fault
from tpvqa.told.strict_json import check_json, check_names

__all__ = ["ToldModel", "check_json", "check_names", "first_fault"]
