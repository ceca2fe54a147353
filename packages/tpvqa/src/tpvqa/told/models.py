"""Models of what others wrote, and the first thing that is wrong with it.

pydantic lists every fault, at a kilobyte each: a file of some megabytes can have millions.
"""

import json
from typing import TYPE_CHECKING, Any, cast

from pydantic import BaseModel, GetCoreSchemaHandler, ValidationError
from pydantic_core import CoreSchema

from tpvqa.errors import cut

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails

_FEW = 100
"""So many faults may be listed."""
_OF_MANY = ("list", "tuple", "set", "frozenset", "dict")


def _fail_fast(schema: Any) -> None:
    if isinstance(schema, dict):
        if schema.get("type") in _OF_MANY:
            schema["fail_fast"] = True
        for part in schema.values():
            _fail_fast(part)
    elif isinstance(schema, (list, tuple)):
        for part in schema:
            _fail_fast(part)


class ToldModel(BaseModel):
    """A model whose sequences and mappings are read up to their first fault."""

    @classmethod
    def __get_pydantic_core_schema__(
        cls, source: type[BaseModel], handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        schema = handler(source)
        _fail_fast(handler.resolve_ref_schema(schema))
        return schema


def first_fault(error: ValidationError) -> "ErrorDetails":
    """The first thing that is wrong; where there are very many, without `ctx` and `input`."""
    if error.error_count() <= _FEW:
        first = error.errors(include_url=False)[0]
    else:  # as text they take a tenth of the memory
        text = error.json(include_url=False, include_context=False, include_input=False)
        first = cast("ErrorDetails", json.JSONDecoder().raw_decode(text, 1)[0])
    place = (part if isinstance(part, int) else cut(part) for part in first["loc"])
    return {**first, "loc": tuple(place)}
