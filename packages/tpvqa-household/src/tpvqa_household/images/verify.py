"""Whether a set of pictures is whole, undamaged and true."""

from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field

from tpvqa.errors import PictureError
from tpvqa.pddl import Atom, State
from tpvqa.pictures import decoded, read_file
from tpvqa.worlds.pictures import MANIFEST, digest
from tpvqa_household.images.manifest import (
    OUTCOMES,
    ActionResult,
    Picture,
    PictureSet,
    Shows,
)
from tpvqa_household.images.reachable import Reachable, say_kind
from tpvqa_household.images.visible import VisibleState, describe, mirrored

PER_STATE = 6
PER_OUTCOME = 10


@dataclass
class Report:
    """What was found.

    Attributes:
        gaps: What is wrong or missing; empty where the set is in order.
        pictures: How many there are.
        states: Pictures by visible state that some task can lead to.
        observations: Pictures by task, action and outcome.
        renderers: Pictures by renderer, those that none rendered by origin.
        origins: Pictures by origin.
        meshes: Pictures by "known" and "held_out".
        size: Bytes in all.
    """

    gaps: list[str] = field(default_factory=list)
    pictures: int = 0
    states: dict[str, int] = field(default_factory=dict)
    observations: dict[tuple[str, str, ActionResult], int] = field(default_factory=dict)
    renderers: Counter[str] = field(default_factory=Counter)
    origins: Counter[str] = field(default_factory=Counter)
    meshes: Counter[str] = field(default_factory=Counter)
    size: int = 0


def observations(visible: VisibleState, tasks: Sequence[Reachable]) -> tuple[Shows, ...]:
    """Which actions of the tasks' plans a visible state is an observation of."""
    found: set[tuple[str, str, ActionResult]] = set()
    for task in tasks:
        for kind in dict.fromkeys(task.nominal):
            if visible in task.after_success(kind):
                found.add((task.task, say_kind(kind), "success"))
            elif visible in task.after_failure(kind):
                found.add((task.task, say_kind(kind), "failure"))
    return tuple(
        Shows(task=task, action=action, outcome=outcome) for task, action, outcome in sorted(found)
    )


def settled(states: Sequence[State], facts: Sequence[Atom]) -> dict[Atom, bool]:
    """The facts that are the same, either hand's, in all true states that look alike."""
    found = {}
    for atom in facts:
        values = {atom in state or mirrored(atom) in state for state in states}
        if len(values) == 1:
            found[atom] = values.pop()
    return found


def verify(pictures: PictureSet, tasks: Sequence[Reachable]) -> Report:
    """Check files, hashes, counts and truth against what the tasks can lead to."""
    report = Report(pictures=len(pictures.manifest.pictures))
    facts = tuple(map(Atom.parse, pictures.manifest.facts))
    classes: dict[VisibleState, list[State]] = defaultdict(list)
    for task in tasks:
        for visible, states in task.classes().items():
            classes[visible] += states
    certain = {describe(v): settled(states, facts) for v, states in classes.items()}
    tags = {
        visible: set(observations(visible, tasks))
        for visible in {
            picture.visible_state
            for picture in pictures.manifest.pictures
            if picture.impossible is None
        }
    }
    for picture in pictures.manifest.pictures:
        report.renderers[picture.renderer or picture.origin.kind] += 1
        report.origins[picture.origin.kind] += 1
        report.meshes[picture.meshes] += 1
        report.size += _check_file(pictures, picture, report.gaps)
        if (why := picture.impossible) is not None:
            report.gaps.append(f"{picture.file}: {why}")
            continue
        _check_truth(picture, facts, certain, tags[picture.visible_state], report.gaps)
    names = Counter(picture.file for picture in pictures.manifest.pictures)
    report.gaps += [f"{name}: listed {n} times" for name, n in names.items() if n > 1]
    listed = set(names) | {MANIFEST}
    report.gaps += [
        f"{path.name}: lies in the folder but is not in the manifest"
        for path in sorted(pictures.folder.glob("*.jpg"))
        if path.name not in listed
    ]
    _check_counts(pictures, classes, tasks, report)
    return report


def _check_file(pictures: PictureSet, picture: Picture, gaps: list[str]) -> int:
    try:
        data = read_file(picture.file, inside=pictures.folder)
    except PictureError as error:
        missing = not (pictures.folder / picture.file).exists()
        gaps.append(f"{picture.file}: missing" if missing else str(error))
        return 0
    if digest(data) != picture.sha256:
        gaps.append(f"{picture.file}: damaged, its SHA-256 is not the manifest's")
        return len(data)
    try:
        size = decoded(data).size
    except PictureError as error:
        gaps.append(f"{picture.file}: {error}")
        return len(data)
    if size != (picture.width, picture.height):
        gaps.append(f"{picture.file}: is {size}, the manifest says otherwise")
    return len(data)


def _check_truth(
    picture: Picture,
    facts: Sequence[Atom],
    certain: dict[str, dict[Atom, bool]],
    tags: set[Shows],
    gaps: list[str],
) -> None:
    unknown = picture.true_state - set(facts)
    if unknown:
        gaps.append(f"{picture.file}: true but not among the facts: {', '.join(map(str, unknown))}")
    if describe(picture.visible_state) != picture.visible:
        gaps.append(
            f"{picture.file}: its facts look like {describe(picture.visible_state)}, "
            f"the manifest says {picture.visible}"
        )
    odd = picture.seen - {atom.pddl() for atom in facts}
    if odd:
        gaps.append(f"{picture.file}: seen but not among the facts: {', '.join(sorted(odd))}")
    if set(picture.shows) != tags:
        gaps.append(f"{picture.file}: is not an observation of the actions that it names")
    sure = certain.get(picture.visible)
    if sure is None:
        return
    for text in sorted(picture.seen):
        atom = Atom.parse(text)
        true = atom in picture.true_state or mirrored(atom) in picture.true_state
        if sure.get(atom) is not true:
            gaps.append(
                f"{picture.file}: shows that {atom} is {str(true).lower()}, "
                "which differs between the true states that it stands for"
            )


def _check_counts(
    pictures: PictureSet,
    classes: dict[VisibleState, list[State]],
    tasks: Sequence[Reachable],
    report: Report,
) -> None:
    for visible in sorted(classes, key=describe):
        count = len(pictures.of(visible))
        report.states[describe(visible)] = count
        if count < PER_STATE:
            report.gaps.append(f"{describe(visible)}: {count} pictures, {PER_STATE} needed")
    found = Counter(
        (shows.task, shows.action, shows.outcome)
        for picture in pictures.manifest.pictures
        for shows in picture.shows
    )
    for task in tasks:
        for kind in dict.fromkeys(task.nominal):
            for outcome in OUTCOMES:
                key = (task.task, say_kind(kind), outcome)
                report.observations[key] = found[key]
                if found[key] < PER_OUTCOME:
                    report.gaps.append(
                        f"{task.task}: {say_kind(kind)}: {found[key]} pictures of a {outcome}, "
                        f"{PER_OUTCOME} needed"
                    )
