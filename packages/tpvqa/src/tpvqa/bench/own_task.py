"""Tasks of users' own in a bench: their files, carried to wherever an episode is run."""

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path
from tempfile import TemporaryDirectory

from tpvqa.errors import BenchError, PlacedError
from tpvqa.files import resolved
from tpvqa.pddl.programs.loading import task_name
from tpvqa.tasks import PROGRAM, QUESTIONS, WORLD, TaskFiles, beside, is_program, shipped_tasks
from tpvqa.tasks.folder import DOMAIN, problems_in
from tpvqa.text_files import read_text

_COMMENT = re.compile(r";[^\n]*")
_IS_DOMAIN = re.compile(r"\(\s*define\s*\(\s*domain\b", re.IGNORECASE)
_NAME = re.compile(r"\(\s*define\s*\(\s*problem\s+([^\s()]+)", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class OwnTask:
    """The texts of a task's files, and where they were read.

    Attributes:
        domain: The PDDL domain, or a logic program.
        problem: The PDDL problem, or the same program.
        questions: How facts and actions are put into questions; None for fallbacks alone.
        world: How facts come undone in a simulated world; None where they do not.
        origin: The files. Another machine may not have them.
    """

    domain: str
    problem: str
    questions: str | None
    world: str | None
    origin: TaskFiles = field(compare=False)

    @classmethod
    def read(cls, files: TaskFiles) -> "OwnTask":
        """Read the files of a task.

        Raises:
            BenchError: One cannot be read.
        """
        return cls(
            _text(files.domain),
            _text(files.problem),
            None if files.questions is None else _text(files.questions),
            None if files.world is None else _text(files.world),
            files,
        )

    @property
    def fingerprint(self) -> str:
        """Tells it from a task whose files say something else."""
        texts = (self.domain, self.problem, self.questions, self.world)
        return sha256(repr(texts).encode()).hexdigest()[:12]

    @contextmanager
    def files(self) -> Iterator[TaskFiles]:
        """Its files: those it was read from, or copies where they are not there (any more)."""
        try:
            as_it_was = OwnTask.read(self.origin) == self
        except BenchError:
            as_it_was = False
        if as_it_was:
            yield self.origin
            return
        with TemporaryDirectory(prefix="tpvqa-task-") as name:
            folder = Path(name)
            program = is_program(self.origin.domain)
            domain = folder / (self.origin.domain.name if program else DOMAIN)
            yield TaskFiles(
                name=self.origin.name,
                domain=_written(domain, self.domain),
                problem=domain if program else _written(folder / "problem.pddl", self.problem),
                questions=None
                if self.questions is None
                else _written(folder / "questions.yaml", self.questions),
                world=None if self.world is None else _written(folder / "world.yaml", self.world),
            )


def own_tasks(
    problems: Sequence[Path],
    *,
    domain: Path | None = None,
    questions: Path | None = None,
    world_file: Path | None = None,
) -> dict[str, OwnTask]:
    """Tasks of one's own, by the names that they have in rows.

    A task has the name of its problem. Where several have that name, or a shipped task does, it is
    as much of the problem's path as tells them apart.

    Args:
        problems: Problem files, logic programs, and folders of them; a domain may come first.
        domain: Their domain; by default that, or the `domain.pddl` beside each problem. A logic
            program is its own.
        questions: Their questions; by default the `questions.yaml` beside problem or domain.
        world_file: How facts come undone; by default the `world.yaml` beside one of them.

    Raises:
        BenchError: A file is missing or cannot be read, or a folder holds no problem.
    """
    if domain is None and len(problems) > 1 and _is_domain(problems[0]):
        domain, problems = problems[0], problems[1:]
    found = [
        OwnTask.read(_files(resolved(path), domain, questions, world_file))
        for path in dict.fromkeys(_expanded(problems, domain))
    ]
    names = Counter(each.origin.name for each in found)
    names.update(files.name for files in shipped_tasks())
    paths = [each.origin.problem for each in found]
    return {
        each.origin.name
        if names[each.origin.name] == 1
        else _end_of(each.origin.problem, paths): each
        for each in found
    }


def _is_domain(path: Path) -> bool:
    return path.is_file() and _IS_DOMAIN.match(_COMMENT.sub("", _text(path)).strip()) is not None


def _end_of(path: Path, paths: Sequence[Path]) -> str:
    """The shortest end of a path, with a folder, that none of the others has."""
    for length in range(2, len(path.parts)):
        if sum(each.parts[-length:] == path.parts[-length:] for each in paths) == 1:
            return "/".join(path.parts[-length:])
    return str(path)


def _expanded(problems: Sequence[Path], domain: Path | None) -> Iterator[Path]:
    for path in problems:
        if not path.is_dir():
            yield path
            continue
        inside = problems_in(path, () if domain is None else (domain,), programs=domain is None)
        if not inside:
            raise BenchError(
                f"{path} holds no problem: *.pddl besides the domain; nor *{PROGRAM} alone"
            )
        yield from inside


def _files(
    problem: Path, domain: Path | None, questions: Path | None, world_file: Path | None
) -> TaskFiles:
    if is_program(problem):
        if domain is not None and resolved(domain) != problem:
            raise BenchError(
                f"{problem} is a logic program, domain and problem in one: leave out --domain"
            )
        name, domain = task_name(problem), problem
    else:
        named = _NAME.search(_COMMENT.sub("", _text(problem)))
        name = named[1].lower() if named else problem.stem
    if domain is None:
        domain = problem.parent / DOMAIN
        if not domain.exists():
            raise BenchError(f"{problem}: there is no {DOMAIN} beside it. Name it with --domain")
    questions = questions or beside(QUESTIONS, problem, domain)
    world_file = world_file or beside(WORLD, problem, domain)
    return TaskFiles(
        name=name,
        domain=resolved(domain),
        problem=problem,
        questions=None if questions is None else resolved(questions),
        world=None if world_file is None else resolved(world_file),
    )


def _text(path: Path) -> str:
    try:
        return read_text(path, PlacedError)
    except PlacedError as error:
        raise BenchError(str(error)) from error


def _written(path: Path, text: str) -> Path:
    path.write_text(text, encoding="utf-8")
    return path
