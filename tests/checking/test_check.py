"""What `tpvqa check` finds: each fault, put into a domain that had none, is found and placed."""

import json
from pathlib import Path

import pytest

from tests.cli.conftest import Run, tpvqa
from tpvqa.checking import Finding, Severity, check
from tpvqa.planning.making import make_planner

__all__ = ["tpvqa"]
DOMAIN = """(define (domain press)
  (:types part - object tray - object)
  (:predicates
    (lies ?p - part ?t - tray)
    (held ?p - part)
    (free)
    (pressed ?p - part)
    (empty ?t - tray))
  (:action pick
    :parameters (?p - part ?t - tray)
    :precondition (and (free) (lies ?p ?t))
    :effect (and (held ?p) (not (free)) (not (lies ?p ?t)) (empty ?t)))
  (:action put
    :parameters (?p - part ?t - tray)
    :precondition (and (held ?p) (empty ?t))
    :effect (and (lies ?p ?t) (free) (not (held ?p)) (not (empty ?t))))
  (:action press
    :parameters (?p - part)
    :precondition (held ?p)
    :effect (pressed ?p)))
"""
PROBLEM = """(define (problem one) (:domain press)
  (:objects lid cap - part in_tray out_tray spare_tray - tray)
  (:init (free) (lies lid in_tray) (lies cap spare_tray) (empty out_tray))
  (:goal (and (pressed lid) (lies lid out_tray))))
"""
QUESTIONS = """predicates:
  lies: "Is the {p} in the {t}?"
  held: "Is the {p} in the gripper?"
  pressed: "Is the {p} flat?"
  empty: "Is the {t} empty?"
actions:
  pick: {say: "pick up the {p} from the {t}", done: "picked up the {p}"}
  put: {say: "put the {p} into the {t}", done: "put the {p} into the {t}"}
  press: {say: "press the {p}", done: "pressed the {p}"}
never_asked:
  - fact: (free)
    because: it follows from what is held
"""
WORLD = """undo:
  - fact: (held ?p)
    outcomes:
      - add: ["(lies ?p spare_tray)", (free)]
sensed:
  - fact: (free)
"""


class Files:
    """A domain with its files, and what is found in it."""

    def __init__(self, folder: Path):
        self.folder = folder
        self.texts = {
            "domain.pddl": DOMAIN,
            "problem.pddl": PROBLEM,
            "questions.yaml": QUESTIONS,
            "world.yaml": WORLD,
        }

    def change(self, file: str, old: str, new: str) -> "Files":
        assert old in self.texts[file]
        self.texts[file] = self.texts[file].replace(old, new)
        return self

    def write(self) -> None:
        for file, text in self.texts.items():
            (self.folder / file).write_text(text)

    def found(self) -> list[Finding]:
        self.write()
        planner = make_planner("fast-downward")
        try:
            return check(
                self.folder / "domain.pddl",
                self.folder / "problem.pddl",
                questions=self.folder / "questions.yaml",
                world_file=self.folder / "world.yaml",
                priors=self.folder / "priors.yaml" if "priors.yaml" in self.texts else None,
                planner=planner,
            )
        finally:
            planner.close()

    def line(self, file: str, word: str) -> int:
        return next(n for n, line in enumerate(self.texts[file].splitlines(), 1) if word in line)


@pytest.fixture
def files(tmp_path: Path) -> Files:
    return Files(tmp_path)


def test_nothing_is_found_where_nothing_is_wrong(files: Files) -> None:
    assert files.found() == []


@pytest.mark.parametrize(
    ("text", "line", "severity", "says"),
    [
        ("(held lid): 0.6\n(held cap): 0.5", 2, Severity.ERROR, "together that is 1.1"),
        ("\n(pressed hat): 0.5", 2, Severity.ERROR, "no object 'hat'"),
        ("(free): 0.5", 1, Severity.WARNING, "has no effect"),
        ("", None, Severity.WARNING, "says nothing"),
        ("(lies lid ?t): 0\n(held lid): 0", 2, Severity.WARNING, "all are taken to be as prob"),
    ],
)
def test_a_file_of_priors_is_checked_too(
    files: Files, text: str, line: int | None, severity: Severity, says: str
) -> None:
    files.texts["priors.yaml"] = text
    (found,) = files.found()
    place = str(files.folder / "priors.yaml") + ("" if line is None else f":{line}")
    assert (found.place, found.severity) == (place, severity)
    assert says in found.says


def test_a_fact_that_is_stated_beside_its_alternatives_is_told(files: Files) -> None:
    choice = "(oneof (lies lid spare_tray) (lies lid out_tray))"
    files.change("problem.pddl", "(lies lid in_tray) ", f"\n{choice} ")
    assert "stated-and-open" not in {each.kind for each in files.found()}
    files.change("problem.pddl", "(free)", "(free) (lies lid in_tray)")
    (found,) = (each for each in files.found() if each.kind == "stated-and-open")
    assert found.severity is Severity.WARNING
    assert found.line == files.line("problem.pddl", "oneof")
    assert found.says.startswith("(lies lid in_tray) is stated beside (oneof (lies lid out_tray) ")


def test_an_empty_file_of_questions_is_told(files: Files) -> None:
    files.texts["questions.yaml"] = "# to be written\n"
    assert "empty-questions" in {each.kind for each in files.found()}


def test_a_byte_order_mark_hides_no_line(files: Files) -> None:
    files.change("questions.yaml", "predicates:\n", "\ufeffpredicates:\n  free: 'Is it free?'\n")
    assert all(each.line for each in files.found() if each.file is not None)


FAULTS = {
    "unknown predicate in questions": (
        "questions.yaml", "  held:", "  helt:", "questions", Severity.ERROR, "helt"),
    "placeholder that is no parameter": (
        "questions.yaml", "Is the {p} flat?", "Is the {part} flat?", "questions",
        Severity.ERROR, "flat"),
    "never asked with a wrong number of arguments": (
        "questions.yaml", "- fact: (free)", '- fact: "(free ?x)"', "questions", Severity.ERROR,
        "free ?x"),
    "fact without a question": (
        "questions.yaml", '  pressed: "Is the {p} flat?"\n', "", "fact-without-question",
        Severity.WARNING, ""),
    "action without words": (
        "questions.yaml", '  press: {say: "press the {p}", done: "pressed the {p}"}\n', "",
        "action-without-words", Severity.NOTE, ""),
    "two predicates in the same words": (
        "questions.yaml", "Is the {p} flat?", "Is the {p} in the gripper?", "same-question",
        Severity.WARNING, "pressed"),
    "another wording in the words of another fact": (
        "questions.yaml", '"Is the {p} flat?"', '["Is it {p}?", "Is the {p} in the gripper?"]',
        "same-question", Severity.WARNING, "pressed"),
    "a word that is said twice": (
        "questions.yaml", "Is the {p} in the {t}?", "Is the {p} in the the {t}?", "doubled-word",
        Severity.WARNING, "lies"),
    "a question that leaves out an object": (
        "questions.yaml", "Is the {p} in the {t}?", "Is the {p} in a tray?", "same-question",
        Severity.NOTE, "lies"),
    "objects whose names only differ in what nobody sees": (
        "questions.yaml", "never_asked:",
        'objects:\n  lid: "fine part"\n  cap: "\\uFB01ne  pa\\u200Brt"\nnever_asked:',
        "same-name", Severity.WARNING, ""),
    "questions that only differ in what nobody sees": (
        "questions.yaml", "Is the {p} flat?", "is the {p} in the\\u00a0grip\\u200Dper?",
        "same-question", Severity.WARNING, "pressed"),
    "objects of the same name": (
        "questions.yaml", "never_asked:", "objects:\n  lid: part\n  cap: part\nnever_asked:",
        "same-name", Severity.WARNING, ""),
    "actions in the same words": (
        "questions.yaml", '"put the {p} into the {t}", done', '"press the {p}", done',
        "same-words-for-actions", Severity.WARNING, ""),
    "an action whose effects nothing shows": (
        "questions.yaml", "never_asked:",
        'never_asked:\n  - fact: "(pressed ?p)"', "effects-unseen", Severity.WARNING, ""),
    "a goal that nothing shows": (
        "questions.yaml", "never_asked:",
        'never_asked:\n  - fact: "(pressed ?p)"', "fact-unseen", Severity.WARNING, ""),
    "a pattern that matches nothing": (
        "questions.yaml", "never_asked:",
        'never_asked:\n  - fact: "(held ?p - tray)"', "questions", Severity.ERROR, "held ?p"),
    "a world file that does not fit": (
        "world.yaml", "(held ?p)", "(helt ?p)", "world", Severity.ERROR, "helt"),
    "swapped arguments of types that can never fit": (
        "domain.pddl", "(and (lies ?p ?t) (free)", "(and (lies ?t ?p) (free)", "pddl",
        Severity.ERROR, "(lies ?t ?p)"),
    "an unknown predicate in the domain": (
        "domain.pddl", ":precondition (held ?p)\n", ":precondition (helt ?p)\n", "pddl",
        Severity.ERROR, "helt"),
    "a precondition that is never true": (
        "domain.pddl", ":precondition (held ?p)\n",
        ":precondition (and (held ?p) (pressed lid_two))\n", "pddl", Severity.ERROR, "lid_two"),
    "a fact that is added and deleted": (
        "domain.pddl", ":effect (pressed ?p)",
        ":effect (and (pressed ?p) (not (pressed ?p)))", "effects-contradict", Severity.WARNING,
        "(not (pressed ?p))"),
    "a fact that is added and deleted in one case": (
        "domain.pddl", ":effect (pressed ?p)",
        ":effect (and (when (held ?p) (pressed ?p)) (when (held ?p) (and (not (pressed ?p)))))",
        "effects-contradict", Severity.WARNING, "(when (held ?p)"),
    "an action without effect of another's name": (
        "domain.pddl", ":effect (pressed ?p)))",
        ":effect (pressed ?p))\n  (:action press :parameters () :effect (and)))", "pddl",
        Severity.ERROR, "(:action press :parameters ()"),
    "a goal out of reach": (
        "problem.pddl", "(pressed lid)", "(held cap) (held lid)", "goal-unreachable",
        Severity.ERROR, "(:goal"),
    "a goal that holds at first": (
        "problem.pddl", "(and (pressed lid) (lies lid out_tray))", "(lies lid in_tray)",
        "goal-holds", Severity.WARNING, "(:goal"),
}  # fmt: skip


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_found_and_placed(files: Files, fault: str) -> None:
    file, old, new, kind, severity, word = FAULTS[fault]
    found = [each for each in files.change(file, old, new).found() if each.kind == kind]
    assert found, fault
    assert found[0].severity is severity
    assert found[0].says
    if word:
        assert found[0].place == f"{files.folder / file}:{files.line(file, word)}"


@pytest.mark.parametrize(
    "effect",
    [
        "(and (pressed ?p) (when (held ?p) (not (pressed ?p))))",
        "(and (when (free) (pressed ?p)) (when (held ?p) (not (pressed ?p))))",
        "(and (pressed ?p) (forall (?o - part) (when (free) (not (pressed ?o)))))",
    ],
)
def test_effects_of_different_cases_contradict_nothing(files: Files, effect: str) -> None:
    files.change("domain.pddl", ":effect (pressed ?p)", f":effect {effect}")
    assert not [each for each in files.found() if each.kind == "effects-contradict"]


def test_all_mistakes_in_the_questions_are_told_at_once(files: Files) -> None:
    files.change("questions.yaml", "  held:", "  helt:").change(
        "questions.yaml", "  press:", "  prest:"
    )
    found = [each for each in files.found() if each.kind == "questions"]
    assert len(found) == 2


def test_actions_that_are_never_possible_are_told_with_what_they_lack(files: Files) -> None:
    extra = """
  (:action polish
    :parameters (?p - part ?t - tray)
    :precondition (and (held ?p) (free) (lies ?p ?t))
    :effect (pressed ?p)))
"""
    files.change("domain.pddl", "    :effect (pressed ?p)))\n", "    :effect (pressed ?p))" + extra)
    files.change("questions.yaml", "actions:", "actions:\n  polish: {say: polish the {p}}")
    files.change("questions.yaml", "polish the {p}}", '"polish the {p}"}')
    files.change("world.yaml", '"(lies ?p spare_tray)", ', "").change(
        "world.yaml", "add: [(free)]", "delete: (pressed ?p)"
    )
    found = [each for each in files.found() if each.kind == "action-never-possible"]
    assert len(found) == 1
    assert "polish" in found[0].says
    assert "never hold together" in found[0].says
    assert found[0].line == files.line("domain.pddl", "(:action polish")


def test_what_an_effect_is_conditional_on_is_needed_like_a_precondition(files: Files) -> None:
    files.change("domain.pddl", "    (pressed ?p - part)", "    (hot)\n    (pressed ?p - part)")
    files.change(
        "domain.pddl",
        "    :effect (pressed ?p)))",
        "    :effect (when (hot) (pressed ?p)))\n  (:action heat :effect (hot)))",
    )
    files.change("questions.yaml", "never_asked:", "never_asked:\n  - fact: (hot)")
    found = [each for each in files.found() if each.kind == "fact-unseen"]
    assert [each.line for each in found] == [files.line("domain.pddl", "(hot)")]
    assert "the action press rests on hot" in found[0].says


def test_a_goal_that_names_a_fact_twice_can_be_reached(files: Files) -> None:
    files.change("problem.pddl", "(:goal (and ", "(:goal (and (lies lid out_tray) ")
    assert not [each for each in files.found() if each.kind == "goal-unreachable"]


def test_what_a_disturbance_brings_about_hides_no_other_impossible_action(files: Files) -> None:
    """What falls back onto a tray makes neither a curse, nor what rests on it, possible."""
    extra = """
  (:action exorcise
    :parameters (?p - part ?t - tray)
    :precondition (and (cursed ?t) (lies ?p ?t))
    :effect (pressed ?p)))
"""
    files.change("domain.pddl", "    :effect (pressed ?p)))\n", "    :effect (pressed ?p))" + extra)
    files.change("domain.pddl", "(free)\n", "(free) (cursed ?t - tray)\n")
    (found,) = (each for each in files.found() if each.kind == "action-never-possible")
    assert "(cursed ?t), which never holds" in found.says
    files.change("world.yaml", '"(lies ?p spare_tray)", ', '"(cursed spare_tray)", ')
    assert "action-never-possible" not in {each.kind for each in files.found()}


def test_an_action_without_objects_or_facts_for_it_is_told(files: Files) -> None:
    extra = """
  (:action paint
    :parameters (?p - part ?b - brush)
    :precondition (held ?p)
    :effect (pressed ?p)))
"""
    files.change("domain.pddl", "    :effect (pressed ?p)))\n", "    :effect (pressed ?p))" + extra)
    files.change("domain.pddl", "tray - object)", "tray - object brush - object)")
    found = [each for each in files.found() if each.kind == "action-never-possible"]
    assert [each for each in found if "no object of the type brush" in each.says]


def test_an_action_whose_numbers_never_allow_it_is_told(files: Files) -> None:
    never = (
        "(:functions (count)) (:action count :parameters () :precondition (< (count) -1) "
        ":effect (increase (count) 1))"
    )
    files.change("domain.pddl", "(:action pick", f"{never}\n  (:action pick")
    files.change("problem.pddl", "(:init", "(:init (= (count) 0)")
    files.found()
    files.change("domain.pddl", "(< (count) -1)", "(> 0 1)")
    assert ["action-never-possible" for each in files.found() if "count" in each.says]


def test_effects_that_differ_in_what_nobody_sees_alone_are_told(files: Files) -> None:
    extra = """
  (:action stamp
    :parameters (?p - part)
    :precondition (held ?p)
    :effect (and (pressed ?p) (marked ?p))))
"""
    files.change("domain.pddl", "    :effect (pressed ?p)))\n", "    :effect (pressed ?p))" + extra)
    files.change("domain.pddl", "(empty ?t - tray))", "(empty ?t - tray) (marked ?p - part))")
    files.change("questions.yaml", "never_asked:", 'never_asked:\n  - fact: "(marked ?p)"')
    found = [each for each in files.found() if each.kind == "effects-alike"]
    assert len(found) == 1
    assert "marked" in found[0].says


def test_what_is_to_be_pasted_mends_what_was_found(files: Files) -> None:
    files.change("questions.yaml", '  pressed: "Is the {p} flat?"\n', "")
    (found,) = files.found()
    assert found.into == str(files.folder / "questions.yaml")
    section, line = found.paste
    files.change("questions.yaml", section, f"{section}\n{line}")
    assert files.found() == []


def test_what_is_to_be_sensed_mends_what_nothing_shows(files: Files) -> None:
    files.change("questions.yaml", "never_asked:", 'never_asked:\n  - fact: "(pressed ?p)"')
    found = [each for each in files.found() if each.kind == "fact-unseen"]
    section, *lines = found[0].paste
    assert section == "sensed:"
    files.change("world.yaml", "sensed:\n", "sensed:\n" + "\n".join(lines) + "\n")
    assert files.found() == []


def test_the_command_tells_places_counts_and_what_to_paste(files: Files, tpvqa: Run) -> None:
    files.change("questions.yaml", '  pressed: "Is the {p} flat?"\n', "").write()
    code, out, _ = tpvqa("check", "domain.pddl", "problem.pddl")
    assert code == 0
    assert "domain.pddl:7: warning: no question is given for the predicate pressed." in out
    assert 'pressed: "Has the {p} been pressed?"' in out
    assert out.splitlines()[-1] == "1 warning"
    assert tpvqa("check", "domain.pddl", "problem.pddl", "--strict")[0] == 1
    code, out, _ = tpvqa("check", "domain.pddl", "problem.pddl", "--json")
    (found,) = json.loads(out)["findings"]
    assert (found["kind"], found["severity"], found["line"]) == (
        "fact-without-question",
        "warning",
        7,
    )


def test_exit_codes_tell_errors_from_what_is_not_there(files: Files, tpvqa: Run) -> None:
    files.change("questions.yaml", "  held:", "  helt:").write()
    assert tpvqa("check", "domain.pddl", "problem.pddl")[0] == 1
    code, _, err = tpvqa("check", "domain.pddl", "elsewhere.pddl")
    assert code == 2
    assert "elsewhere.pddl" in err
    files.change("domain.pddl", "(:action press", "(:acton press").write()
    code, out, _ = tpvqa("check", "domain.pddl", "problem.pddl")
    assert code == 1
    assert "domain.pddl:" in out


@pytest.mark.parametrize("name", ["eat_apple", "clean_dishes", "serve_breakfast", "build_tower"])
def test_shipped_tasks_have_no_errors(name: str, tpvqa: Run) -> None:
    code, out, _ = tpvqa("check", name)
    assert code == 0, out


def test_parts_of_an_action_that_lasts_are_no_findings(tpvqa: Run) -> None:
    files = Path(__file__).parents[2] / "examples/timed/laboratory"
    code, out, _ = tpvqa("check", files / "domain.pddl", files / "problem.pddl", "--strict")
    assert code == 0, out
    assert "can never be done" not in out


def test_an_action_that_only_ends_what_never_holds_is_said_to_change_nothing(tpvqa: Run) -> None:
    """Not that it cannot be done: nothing is wrong with its precondition."""
    Path("domain.pddl").write_text(
        """(define (domain dusting) (:requirements :strips :typing) (:types bench)
        (:predicates (far ?b - bench) (near ?b - bench) (dusty ?b - bench))
        (:action go :parameters (?b - bench) :precondition (far ?b)
          :effect (and (near ?b) (not (far ?b))))
        (:action dust :parameters (?b - bench) :precondition (near ?b) :effect (not (dusty ?b))))"""
    )
    Path("problem.pddl").write_text(
        """(define (problem one) (:domain dusting) (:objects b - bench) (:init (far b))
        (:goal (near b)))"""
    )
    _, out, _ = tpvqa("check", "domain.pddl", "problem.pddl")
    assert "domain.pddl:5: warning: the action dust changes nothing" in out
    assert "(dusty ?b), which never holds" in out
    assert "can never be done" not in out
