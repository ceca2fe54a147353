"""Drafted questions: what they say, and that they are a questions file that needs no fallback."""

import re
from pathlib import Path

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from tpvqa.drafting import draft, words
from tpvqa.pddl import Literal, Task, load_task
from tpvqa.pddl.loading import task_from_text
from tpvqa.pddl.whole import seen_predicates
from tpvqa.planning import Plan
from tpvqa.planning.making import make_planner
from tpvqa.questions import QuestionBook

ROOT = Path(__file__).parents[2]
TASKS = [
    *((folder / "domain.pddl", folder / "problem.pddl") for folder in ROOT.glob("examples/**/")
      if (folder / "domain.pddl").exists()),
    (ROOT / "tests/fixtures/toys/domain.pddl", ROOT / "tests/fixtures/toys/collect.pddl"),
    (ROOT / "tests/fixtures/ward/domain.pddl", ROOT / "tests/fixtures/ward/problem.pddl"),
    (ROOT / "tests/fixtures/drawer/domain.pddl", ROOT / "tests/fixtures/drawer/problem.pddl"),
]  # fmt: skip
TYPES = (
    """(:types robot block table drawer door room key switch plate person arm color cup - object)"""
)
OBJECTS = """front_door - door top_drawer - drawer ceiling_light - switch robot - robot key1 - key
  red_block blue_block - block kitchen - room plate - plate mug - cup blue - color
  anna - person left right - arm desk - table beans - plate"""
SAID = {
    "(isOpen ?d - door)": "Is the front door open?",
    "(opened ?d - drawer)": "Is the top drawer open?",
    "(closed ?d - door)": "Is the front door closed?",
    "(toggledOn ?s - switch)": "Is the ceiling light toggled on?",
    "(switched_off ?s - switch)": "Is the ceiling light switched off?",
    "(has-key ?r - robot ?k - key)": "Does the robot have key 1?",
    "(have_key ?k - key)": "Does the robot have key 1?",
    "(holding-can)": "Is the robot holding a can?",
    "(carrying_water)": "Is the robot carrying any water?",
    "(holding-nothing)": "Is the robot holding nothing?",
    "(has-drill)": "Does the robot have a drill?",
    "(has_keys)": "Does the robot have any keys?",
    "(robotAt ?r - room)": "Is the robot in the kitchen?",
    "(at-robot ?r - room)": "Is the robot in the kitchen?",
    "(in-hand ?b - block ?a - arm)": "Is the red block in the left arm?",
    "(holding ?b - block)": "Is the robot holding the red block?",
    "(is_holding ?p - person ?b - block)": "Is Anna holding the red block?",
    "(held ?b - block ?r - robot)": "Is the red block held by the robot?",
    "(handEmpty)": "Is the robot's hand empty?",
    "(handempty)": "Is the robot's hand empty?",
    "(free_hands)": "Are the robot's hands free?",
    "(free-handed)": "Are the robot's hands free?",
    "(in_the_air ?b - block)": "Is the red block in the air?",
    "(running ?b - block)": "Is the red block running?",
    "(arm-free ?a - arm)": "Is the left arm free?",
    "(OnTable ?b - block)": "Is the red block on the table?",
    "(on ?a - block ?t - table)": "Is the red block on the desk?",
    "(on-top-of ?a ?b - block)": "Is the blue block on top of the blue block?",
    "(at ?p - person ?r - room)": "Is Anna in the kitchen?",
    "(inside ?b - block ?d - drawer)": "Is the red block inside the top drawer?",
    "(washed ?p - block)": "Has the red block been washed?",
    "(cut_in_half ?b - block)": "Is the red block cut in half?",
    "(not-dirty ?p - table)": "Is it true that the desk is not dirty?",
    "(filled-with ?c - cup ?b - block)": "Is the mug filled with the red block?",
    "(painted ?b - block ?c - color)": "Is the red block painted blue?",
    "(colour ?b - block ?c - color)": "Is the red block blue?",
    "(contains ?d - drawer ?b - block)": "Does the top drawer contain the red block?",
    "(carries ?r - robot ?b - block)": "Is the robot carrying the red block?",
    "(between ?a ?b ?c - table)": "Is the desk between the desk and the desk?",
    "(moved ?b - block ?from ?to - room)":
        "Has the red block been moved from the kitchen to the kitchen?",
    "(boarded ?p - person)": "Has Anna boarded?",
    "(light-on)": "Is the light on?",
    "(lightOn ?r - room)": "Is the light in the kitchen on?",
    "(battery-low ?r - robot)": "Is the battery of the robot low?",
    "(can-reach ?r - robot ?b - block)": "Can the robot reach the red block?",
    "(has-water ?c - cup)": "Does the mug have any water?",
    "(clear ?t - table)": "Is the top of the desk clear?",
    "(at-table ?t - table)": "Is the robot at the desk?",
    "(raining)": "Is it raining?",
    "(lying ?p - person)": "Is Anna lying?",
    "(clean ?p - plate)": "Is the plate clean?",
    "(lies-on ?b - block ?t - table)": "Is the red block on the desk?",
    "(hangs-from ?c - cup ?t - table)": "Is the mug hanging from the desk?",
    "(stands-at ?r - robot ?t - table)": "Is the robot at the desk?",
    "(lies-next-to ?b - block ?t - table)": "Is the red block next to the desk?",
    "(in-front-of ?c - cup ?t - table)": "Is the mug in front of the desk?",
    "(stands-in-front-of ?r - robot ?t - table)": "Is the robot in front of the desk?",
    "(lies-on-top-of ?a ?b - block)": "Is the red block on top of the red block?",
    "(lies-between ?a ?b ?c - table)": "Is the desk between the desk and the desk?",
    "(sits-at ?r - robot ?s - room)": "Is the robot in the kitchen?",
    "(belongs-to ?c - cup ?p - person)": "Does the mug belong to Anna?",
    "(fits-in ?b - block ?d - drawer)": "Does the red block fit in the top drawer?",
    "(breaker-on ?r - room)": "Is the breaker in the kitchen on?",
    "(red-light-on ?s - switch)": "Is the red light of the ceiling light on?",
    "(left-hand-free ?r - robot)": "Is the robot's left hand free?",
    "(left-open ?d - drawer)": "Is the top drawer left open?",
    "(eef-has ?b - block)": "Does the eef have the red block?",
    "(no-cover ?c - cup)": "Is it true that the mug does not have a cover?",
    "(quick-release-open ?t - table)": "Is the quick release of the desk open?",
    "(front_flap_stuck ?t - table)": "Is the front flap of the desk stuck?",
    "(wide-open ?d - door)": "Is the front door wide open?",
    "(tightly-closed ?d - door)": "Is the front door tightly closed?",
    "(half-full ?c - cup)": "Is the mug half full?",
    "(front-open ?t - table)": "Is the front of the desk open?",
    "(top-open ?t - table)": "Is the top of the desk open?",
    "(right-side-up ?c - cup)": "Is the mug right side up?",
    "(stick-broken ?t - table)": "Is the stick of the desk broken?",
    "(newly-painted ?t - table)": "Is the desk newly painted?",
    "(fully-open ?d - door)": "Is the front door fully open?",
    "(front-door-open ?d - door)": "Is the front door open?",
    "(hitched ?b - block ?r - robot)": "Is the red block hitched to the robot?",
    "(robot-holds ?b - block)": "Is the robot holding the red block?",
    "(switch-turned-on ?s - switch)": "Is the ceiling light turned on?",
    "(cup-connected-to ?c - cup ?t - table)": "Is the mug connected to the desk?",
    "(cup-in-drawer ?c - cup ?d - drawer)": "Is the mug in the top drawer?",
    "(carrying-key ?k - key)": "Is the robot carrying key 1?",
    "(cup-standing ?c - cup)": "Is the mug standing?",
    "(door-closing ?d - door)": "Is the front door closing?",
    "(key-inserted-in-door ?k - key ?d - door)": "Is key 1 inserted in the front door?",
}  # fmt: skip


def task_of(predicates: list[str]) -> Task:
    """A task in which one action changes all of some predicates."""
    heads = [re.sub(r" - \w+", "", each) for each in predicates]
    parameters, effects = [], []
    for number, (each, head) in enumerate(zip(predicates, heads, strict=True)):
        mine = re.sub(r"\?(\w+)", rf"?\g<1>{number}", each)
        parameters.append(re.sub(r"^\(\S+\s*|\)$", "", mine))
        effects.append(re.sub(r"\?(\w+)", rf"?\g<1>{number}", head))
    actions = "\n".join(
        f"(:action do{n} :parameters ({p}) :precondition (and) :effect {e})"
        for n, (p, e) in enumerate(zip(parameters, effects, strict=True))
    )
    domain = f"(define (domain d) {TYPES} (:predicates {' '.join(predicates)}) {actions})"
    problem = f"(define (problem p) (:domain d) (:objects {OBJECTS}) (:init) (:goal (and)))"
    return task_from_text(domain, problem)


def book_of(task: Task, folder: Path) -> QuestionBook:
    file = folder / "questions.yaml"
    file.write_text(draft(task), encoding="utf-8")
    return QuestionBook.load(file, task)


@pytest.fixture(scope="module")
def said(tmp_path_factory: pytest.TempPathFactory) -> dict[str, set[str]]:
    """All questions about each of the predicates."""
    found: dict[str, set[str]] = {}
    names: set[str] = set()
    groups: list[list[str]] = [[]]
    for each in SAID:  # PDDL knows no capitals: two names that differ by them go apart
        name = each.strip("()").split()[0].lower()
        if name in names:
            groups.append([each])
        else:
            groups[0].append(each)
        names.add(name)
    for group in groups:
        task = task_of(group)
        book = book_of(task, tmp_path_factory.mktemp("draft"))
        for each in group:
            name = each.strip("()").split()[0].lower()
            atoms = [atom for atom in task.atoms() if atom.predicate == name]
            found[each] = {book.fact(Literal(atom)).text for atom in atoms}
    return found


@pytest.mark.parametrize("predicate", SAID)
def test_predicates_become_questions_that_people_ask(
    predicate: str, said: dict[str, set[str]]
) -> None:
    assert SAID[predicate] in said[predicate]


def test_what_is_stored_is_in_a_box_and_on_a_shelf(tmp_path: Path) -> None:
    domain, problem = tmp_path / "domain.pddl", tmp_path / "problem.pddl"
    domain.write_text(
        "(define (domain lab) (:requirements :typing) (:types vial shelf box - object)"
        " (:predicates (stored ?v - vial ?s - shelf) (packed ?v - vial ?b - box))"
        " (:action put :parameters (?v - vial ?s - shelf ?b - box)"
        " :precondition (stored ?v ?s) :effect (and (packed ?v ?b) (not (stored ?v ?s)))))"
    )
    problem.write_text(
        "(define (problem p) (:domain lab) (:objects sample - vial top_shelf - shelf"
        " red_box - box) (:init (stored sample top_shelf)) (:goal (packed sample red_box)))"
    )
    written = draft(load_task(domain, problem))
    assert "Is the {v} stored on the {s}?" in written
    assert "Is the {v} packed in the {b}?" in written


@pytest.mark.parametrize(
    ("second", "asked"),
    [("bench", "Is the robot at the {s}?"), ("kitchen", "Is the robot in the {s}?")],
)
def test_who_stands_at_a_bench_is_not_on_it(second: str, asked: str) -> None:
    domain = """(define (domain lab) (:types station item - object)
      (:predicates (robot-at ?s - station) (stored ?i - item ?s - station))
      (:action take :parameters (?i - item ?s - station)
        :precondition (and (robot-at ?s) (stored ?i ?s)) :effect (not (stored ?i ?s)))
      (:action drive :parameters (?from ?to - station)
        :precondition (robot-at ?from) :effect (and (not (robot-at ?from)) (robot-at ?to))))"""
    places = f"pantry {second}"
    problem = f"""(define (problem p) (:domain lab) (:objects {places} - station tube - item)
      (:init (robot-at pantry) (stored tube {second})) (:goal (not (stored tube {second}))))"""
    written = yaml.safe_load(draft(task_from_text(domain, problem)))["predicates"]
    assert written["robot-at"][0] == asked


TOWER = """(define (domain tower) (:types lift room floor can slot tote shelf - object)
  (:predicates (robot-in ?r - room) (robot-inside ?l - lift) (lift-at ?l - lift ?f - floor)
    (can-in-slot ?c - can ?s - slot) (stored ?c - can ?s - shelf) (held ?c - can)
    (in-tote ?c - can ?t - tote) (delivered ?t - tote))
  (:action call-lift :parameters (?l - lift ?from ?to - floor)
    :precondition (lift-at ?l ?from) :effect (and (lift-at ?l ?to) (not (lift-at ?l ?from))))
  (:action board-lift :parameters (?l - lift ?r - room) :precondition (robot-in ?r)
    :effect (and (robot-inside ?l) (not (robot-in ?r))))
  (:action leave-lift :parameters (?l - lift ?r - room) :precondition (robot-inside ?l)
    :effect (and (robot-in ?r) (not (robot-inside ?l))))
  (:action put-down :parameters (?c - can ?s - shelf) :precondition (held ?c)
    :effect (and (stored ?c ?s) (not (held ?c))))
  (:action fill :parameters (?c - can ?s - slot) :precondition (held ?c)
    :effect (can-in-slot ?c ?s))
  (:action drop-in-tote :parameters (?c - can ?t - tote) :precondition (held ?c)
    :effect (and (in-tote ?c ?t) (not (held ?c))))
  (:action enter-room :parameters (?from ?to - room) :precondition (robot-in ?from)
    :effect (and (robot-in ?to) (not (robot-in ?from))))
  (:action pick-by-hand :parameters (?c - can ?s - shelf) :precondition (stored ?c ?s)
    :effect (and (held ?c) (not (stored ?c ?s))))
  (:action push-through-hatch :parameters (?t - tote) :effect (delivered ?t)))"""


def test_what_a_name_says_of_its_arguments_is_said_once() -> None:
    problem = """(define (problem p) (:domain tower) (:objects north-lift - lift hall yard - room
        low high - floor cola - can upper-slot - slot red-tote - tote steel-shelf - shelf)
      (:init (robot-in hall) (held cola)) (:goal (delivered red-tote)))"""
    written = yaml.safe_load(draft(task_from_text(TOWER, problem)))
    said = {name: each["say"] for name, each in written["actions"].items()}
    assert said["call-lift"] == "call the {l} from the {from} to the {to}"
    assert said["board-lift"].startswith("board the {l}")
    assert said["leave-lift"].startswith("leave the {l}")
    assert said["enter-room"] == "enter the {to}"
    assert said["pick-by-hand"] == "pick up the {c} from the {s} by hand"
    assert said["put-down"] == "put down the {c} on the {s}"
    assert said["drop-in-tote"] == "drop the {c} into the {t}"
    assert said["push-through-hatch"] == "push the {t} through the hatch"
    assert written["predicates"]["can-in-slot"][0] == "Is the {c} in the {s}?"


ENDING = """(define (domain set) (:types lamp circuit - object)
  (:predicates (bolted ?l - lamp) (bus-on ?c - circuit) (bus-off ?c - circuit) (metered ?l - lamp))
  (:action undo :parameters (?l - lamp) :precondition (bolted ?l)
    :effect (and (not (bolted ?l)) (metered ?l)))
  (:action insert :parameters (?l - lamp ?c - circuit) :precondition (bus-on ?c)
    :effect (and (bolted ?l) (bus-off ?c) (not (bus-on ?c)))))"""


def test_what_can_end_is_asked_as_it_is_now_and_what_no_picture_shows_is_marked() -> None:
    problem = """(define (problem p) (:domain set) (:objects key_lamp - lamp circuit-a - circuit)
      (:init (bolted key_lamp) (bus-on circuit-a)) (:goal (metered key_lamp)))"""
    written = draft(task_from_text(ENDING, problem))
    asked = yaml.safe_load(written)["predicates"]
    assert asked["bolted"][0] == "Is the {l} bolted?"
    assert not any("been" in each for each in asked["bolted"])
    assert asked["bus-on"][0] == "Is the bus of {c.the} on?"
    assert asked["bus-off"][0] == "Is the bus of {c.the} off?"
    assert "metered:   # LOOK: does a picture show it?" in written
    assert "insert the {l} into {c.the}" in written
    assert 'name: "circuit A", the: "{name}"' in written or 'circuit-a: "circuit A"' in written


def test_verbs_agree_with_several_things(said: dict[str, set[str]]) -> None:
    assert "Are the beans clean?" in said["(clean ?p - plate)"]


@pytest.mark.parametrize("files", TASKS, ids=lambda files: files[0].parent.name)
def test_a_draft_is_a_whole_questions_file(files: tuple[Path, Path], tmp_path: Path) -> None:
    task = load_task(*files)
    book = book_of(task, tmp_path)
    assert book.notices == []
    plain = task.lasting is None and task.numeric is None
    if not plain:
        pytest.importorskip("up_aries")
    planner = make_planner("fast-downward" if plain else "up:aries")
    plan = planner.plan(task)
    planner.close()
    assert isinstance(plan, Plan)
    state = task.init
    for action in plan.actions:
        for question in (*book.preconditions(action, state), *book.effects(action, state)):
            assert re.fullmatch(r"(?:Is|Are|Has|Have|Does|Do|Can) \S.*\S\?", question.text)
            assert not re.search(r"\b(\w+) \1\b|  |[{}_]", question.text), question.text
        assert not re.search(r"  |[{}_]", book.say(action))
        state = task.apply(state, action)


@pytest.mark.parametrize("files", TASKS, ids=lambda files: files[0].parent.name)
def test_every_predicate_has_other_words_where_errors_last(files: tuple[Path, Path]) -> None:
    task = load_task(*files)
    given = yaml.safe_load(draft(task))["predicates"]
    for name in seen_predicates(task):
        first, *others = given[name]
        assert others
        assert first not in others


NAMES = st.from_regex(r"[a-z][a-z]{0,9}([_-][a-z0-9]{1,7}){0,3}", fullmatch=True)


@settings(max_examples=25, deadline=None)
@given(st.lists(NAMES, min_size=1, max_size=6, unique_by=str.lower), st.data())
def test_whatever_names_there_are_a_draft_can_be_read(
    names: list[str], data: st.DataObject
) -> None:
    reserved = {"and", "or", "not", "forall", "exists", "when", "imply", "define", "either"}
    predicates = [
        f"({name} {' '.join(f'?x{n} - block' for n in range(data.draw(st.integers(0, 3))))})"
        for name in names
        if name not in reserved
    ]
    if not predicates:
        return
    task = task_of(predicates)
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        book = book_of(task, Path(folder))
    assert book.notices == []
    plain = words(task)
    assert set(plain.questions) == {p.strip("()").split()[0] for p in predicates}
    assert all("." not in place for each in plain.questions.values()
               for place in re.findall(r"{(.*?)}", each))  # fmt: skip
