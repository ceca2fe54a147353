"""Which pictures a set consists of, each with all that decides it."""

import json
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence, Set
from dataclasses import dataclass, field, replace
from pathlib import Path

from tpvqa.chance import chance
from tpvqa.pddl import State
from tpvqa.worlds.pictures import digest
from tpvqa_household.images.manifest import OriginKind, Picture, PictureSet
from tpvqa_household.images.reachable import Reachable
from tpvqa_household.images.recipe import FACTS, needed
from tpvqa_household.images.sources.generator import ImageGenerator
from tpvqa_household.images.sources.labels import Label
from tpvqa_household.images.sources.photos import Photo
from tpvqa_household.images.sources.prompts import Prompts
from tpvqa_household.images.sources.shares import Shares
from tpvqa_household.images.verify import PER_OUTCOME, PER_STATE
from tpvqa_household.images.visible import VisibleState, describe, visible_state, without_hands


@dataclass(frozen=True)
class Source:
    """A picture that is taken over or varied.

    Attributes:
        path: The file.
        name: As the manifest names it.
        sha256: Of the file.
        state: What is true in it.
        picture: Its entry in the manifest of the rendered set; None for a photo.
    """

    path: Path
    name: str
    sha256: str = field(repr=False)
    state: State = field(repr=False)
    picture: Picture | None = field(repr=False)


@dataclass(frozen=True)
class Wanted:
    """A picture of the set to be.

    Attributes:
        file: Its name, which is another for everything that would make it another picture.
        kind: What it is.
        label: What it is got for; None where it only serves a state that tasks can come to.
        number: Tells it from others of the same visible state.
        state: What is true in it.
        seen: The facts that can be told from it, unless its generator knows better.
        source: What it is, or is varied from.
        prompt: What is asked for in words.
        generator: What makes it.
        seed: What its generator is given.
    """

    file: str
    kind: OriginKind
    label: Label | None
    number: int
    state: State = field(repr=False)
    seen: frozenset[str] = field(repr=False)
    source: Source | None = None
    prompt: str = ""
    generator: ImageGenerator | None = None
    seed: int | None = None

    @property
    def visible(self) -> VisibleState:
        """What the camera shows."""
        return visible_state(self.state)


@dataclass(frozen=True)
class Ingredients:
    """What a set is composed from.

    Attributes:
        labels: The actions and outcomes.
        photos: The user's photos.
        rendered: Stands in for what is not there.
        prompts: What is asked for in words.
        varier: Makes the variations; None lets rendered pictures stand in.
        prompted: Makes pictures from prompts; None lets rendered pictures stand in.
    """

    labels: Sequence[Label]
    photos: Sequence[Photo]
    rendered: PictureSet
    prompts: Prompts
    varier: ImageGenerator | None = None
    prompted: ImageGenerator | None = None


def plan(
    of: Ingredients,
    *,
    shares: Shares,
    count: int = PER_OUTCOME,
    seed: int = 0,
    rejected: Set[str] = frozenset(),
    tasks: Sequence[Reachable] = (),
) -> list[Wanted]:
    """The pictures of a set, the same for the same arguments.

    Args:
        of: What it is composed from.
        shares: Of photos, variations and pictures from prompts, for each action's outcome.
        count: Pictures of each action's outcome.
        seed: Decides which pictures stand in and what generators are given.
        rejected: Files that are not wanted; others are made instead.
        tasks: Rendered pictures are added of what else these can come to.
    """
    made = list(_labelled(of, shares.of(count), seed, rejected))
    taken = {wanted.file for wanted in made}
    counts = Counter(wanted.visible for wanted in made)
    classes = {visible for task in tasks for visible in task.classes()}
    for visible in sorted(classes, key=describe):
        free = [p for p in of.rendered.of(visible) if p.file not in taken | rejected]
        more = free[: max(0, PER_STATE - counts[visible])]
        made += [_rendered(of.rendered, picture, None) for picture in more]
    return _numbered(made)


def _labelled(
    of: Ingredients, parts: tuple[int, int, int], seed: int, rejected: Set[str]
) -> Iterator[Wanted]:
    photos: dict[Label, list[Photo]] = defaultdict(list)
    for photo in of.photos:
        if _photo(of, photo).file not in rejected:
            photos[photo.label].append(photo)
    in_photos, in_variations, in_prompts = parts
    lacking = {}
    for label in of.labels:
        lacking[label] = max(0, in_photos - len(photos[label]))
        lacking[label] += in_variations if of.varier is None else 0
        lacking[label] += in_prompts if of.prompted is None else 0
    stand_ins = _stand_ins(of.rendered, lacking, seed, rejected)
    for label in of.labels:
        own = [_photo(of, photo) for photo in photos[label]]
        yield from own[:in_photos]
        yield from (_rendered(of.rendered, picture, label) for picture in stand_ins[label])
        if of.varier is not None:
            chosen = own or [_rendered(of.rendered, p, label) for p in stand_ins[label]]
            chosen = chosen or [
                _rendered(of.rendered, picture, label)
                for picture in _candidates(of.rendered, label, seed, rejected)[:1]
            ]
            # Those of one original come after each other: its kitchen is compiled once.
            for number in sorted(range(in_variations), key=lambda n: n % len(chosen)):
                original = chosen[number % len(chosen)]
                yield _variation(of, of.varier, label, original, number, seed, rejected)
        if of.prompted is not None:
            for number in range(in_prompts):
                yield _generated(of, of.prompted, label, number, seed, rejected)


def _candidates(rendered: PictureSet, label: Label, seed: int, rejected: Set[str]) -> list[Picture]:
    """Rendered pictures of a label: those of its usual state first, otherwise in random order."""
    usual = describe(visible_state(label.state))
    found = [
        picture
        for picture in rendered.manifest.pictures
        if label.shows in picture.shows and picture.file not in rejected
    ]
    chance(seed, 0, "stand-in", label.slug).shuffle(found)
    return sorted(found, key=lambda picture: picture.visible != usual)


def _stand_ins(
    rendered: PictureSet, lacking: dict[Label, int], seed: int, rejected: Set[str]
) -> dict[Label, list[Picture]]:
    """Rendered pictures for each label, none of them twice; labels with few choices come first."""
    choices = {label: _candidates(rendered, label, seed, rejected) for label in lacking}
    taken: set[str] = set()
    found = {}
    for label in sorted(lacking, key=lambda label: len(choices[label])):
        free = [picture for picture in choices[label] if picture.file not in taken]
        found[label] = free[: lacking[label]]
        taken |= {picture.file for picture in found[label]}
    return found


def _rendered(rendered: PictureSet, picture: Picture, label: Label | None) -> Wanted:
    path = rendered.folder / picture.file
    source = Source(path, picture.file, picture.sha256, picture.true_state, picture)
    return Wanted(picture.file, "rendered", label, 0, source.state, picture.seen, source)


def _photo(of: Ingredients, photo: Photo) -> Wanted:
    source = Source(photo.path, photo.name, photo.sha256, photo.state, None)
    seen = told(visible_state(photo.state), of.rendered)
    file = f"{photo.label.slug}-photo-{photo.sha256[:12]}.jpg"
    return Wanted(file, "photo", photo.label, 0, photo.state, seen, source)


def _variation(
    of: Ingredients,
    by: ImageGenerator,
    label: Label,
    original: Wanted,
    number: int,
    seed: int,
    rejected: Set[str],
) -> Wanted:
    source = original.source
    assert source is not None
    as_usual = visible_state(source.state) == visible_state(label.state)
    prompt = of.prompts.for_variation(label, as_usual=as_usual)
    for attempt in range(len(rejected) + 1):
        given = _seed(seed, "variation", label, number, attempt)
        file = _file(label, "variation", by, given, prompt, source.sha256)
        if file not in rejected:
            break
    return Wanted(
        *(file, "variation", label, 0, source.state, original.seen, source, prompt, by, given)
    )


def _generated(
    of: Ingredients,
    by: ImageGenerator,
    label: Label,
    number: int,
    seed: int,
    rejected: Set[str],
) -> Wanted:
    prompt = of.prompts.of(label, number)
    for attempt in range(len(rejected) + 1):
        given = _seed(seed, "generated", label, number, attempt)
        file = _file(label, "generated", by, given, prompt, "")
        if file not in rejected:
            break
    seen = told(visible_state(label.state), of.rendered)
    return Wanted(file, "generated", label, 0, label.state, seen, None, prompt, by, given)


def _seed(seed: int, kind: str, label: Label, number: int, attempt: int) -> int:
    return chance(seed, 0, kind, label.slug, number, attempt).randrange(2**31)


def _file(label: Label, kind: str, by: ImageGenerator, seed: int, prompt: str, source: str) -> str:
    """A name that is another for another picture: what was paid for once is found by it."""
    decides = json.dumps([by.name, by.settings, seed, prompt, source]).encode()
    return f"{label.slug}-{kind}-{digest(decides)[:12]}.jpg"


def told(visible: VisibleState, rendered: PictureSet) -> frozenset[str]:
    """The facts that a picture of a visible state is taken to show.

    Nobody counts the pixels of a photo: what every rendered picture of the state shows, it shows.
    """
    pictures = rendered.of(visible)
    if pictures:
        return frozenset.intersection(*(picture.seen for picture in pictures))
    shown = needed(visible)
    return frozenset(atom.pddl() for atom in FACTS if without_hands(atom) in shown)


def _numbered(made: Sequence[Wanted]) -> list[Wanted]:
    counts: Counter[VisibleState] = Counter()
    numbered = []
    for wanted in made:
        visible = wanted.visible
        numbered.append(replace(wanted, number=counts[visible]))
        counts[visible] += 1
    return numbered
