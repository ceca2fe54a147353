"""What a reader of the pages and the messages relies on."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGES = [
    *ROOT.glob("*.md"),
    *ROOT.glob("docs/*.md"),
    *ROOT.glob("packages/*/*.md"),
    *ROOT.glob("experiments/*.md"),
    *ROOT.glob("examples/**/*.md"),
]
TEXTS = [
    *PAGES,
    *ROOT.glob("CITATION.cff"),
    *ROOT.glob("packages/*/pyproject.toml"),
    *ROOT.glob("packages/*/src/**/*.py"),
    *ROOT.glob("experiments/src/**/*.py"),
]
CODE = re.compile(r"```.*?```|`[^`]*`", re.DOTALL)
LINK = re.compile(r"\]\(([^)#:]+)(?:#([\w-]+))?\)")
FROM_AN_INDEX = re.compile(r"(?:install|-e)\s+['\"]?tpvqa")
FOLDER = re.compile(r"-e '?(packages/[\w-]+|experiments)(?:\[(\w+)\])?")


def anchors(page: Path) -> set[str]:
    """What a link to a page may name after #."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(), re.MULTILINE)
    return {re.sub(r"[^\w -]", "", text.lower()).replace(" ", "-") for text in headings}


def test_links_lead_somewhere() -> None:
    for page in PAGES:
        for target, anchor in LINK.findall(CODE.sub("", page.read_text())):
            there = page.parent / target
            assert there.exists(), f"{page}: {target}"
            assert not anchor or anchor in anchors(there), f"{page}: {target}#{anchor}"


def test_what_is_to_be_installed_is_a_folder_of_a_clone() -> None:
    """No package index has these distributions."""
    for text in TEXTS:
        told = text.read_text()
        assert not FROM_AN_INDEX.findall(told), text
        for folder, extra in FOLDER.findall(told):
            project = (ROOT / folder / "pyproject.toml").read_text()
            assert not extra or re.search(rf"^{extra} = \[", project, re.MULTILINE), (text, extra)


def test_the_kitchen_is_called_physical_in_its_falls_alone() -> None:
    for text in TEXTS:
        told = " ".join(text.read_text().split())
        assert not re.search(r"rendered(,| and) physical", told, re.IGNORECASE), text


def test_the_front_page_fits_on_a_few_screens() -> None:
    assert len((ROOT / "README.md").read_text().splitlines()) < 150


def test_every_page_is_in_the_index() -> None:
    index = (ROOT / "docs" / "README.md").read_text()
    pages = {page.name for page in (ROOT / "docs").glob("*.md")} - {"README.md"}
    assert {name for name in pages if f"({name})" not in index} == set()
