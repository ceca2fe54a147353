"""Templates of HTML pages; what they are filled with may be a stranger's."""

from typing import TYPE_CHECKING

from tpvqa.spelling import spelled

if TYPE_CHECKING:
    from jinja2 import Template


def template(package: str, name: str = "report.html.j2") -> "Template":
    """A template: values become text of the page, never markup, and invisible ones are shown.

    Args:
        package: The one in which it lies, and what it includes.
        name: Its file.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined

    return Environment(
        loader=PackageLoader(package, "."),
        autoescape=True,
        undefined=StrictUndefined,
        finalize=_shown,
        trim_blocks=True,
        lstrip_blocks=True,
    ).get_template(name)


def _shown(value: object) -> object:
    return spelled(value, lines=True) if type(value) is str else value  # markup is not a stranger's
