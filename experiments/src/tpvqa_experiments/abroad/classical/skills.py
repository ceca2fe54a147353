"""Kinds in which tools are used."""

from random import Random

from tpvqa_experiments.abroad.classical.kind import Drawn, Kind, named, roads


def _satellite(
    random: Random,
) -> Drawn:
    crafts, tools = named("craft", 2), named("tool", 3)
    sides, modes = named("side", 5), named("mode", 2)
    init = [f"idle {each}" for each in crafts]
    init += [f"faces {each} {random.choice(sides)}" for each in crafts]
    for number, tool in enumerate(tools):
        init += [f"aboard {tool} {crafts[number % 2]}", f"target {tool} {random.choice(sides)}"]
        init.append(f"takes {tool} {modes[number % 2]}")
    wanted = random.sample(sides, 3)
    return (
        {"craft": crafts, "tool": tools, "side": sides, "mode": modes},
        init,
        [f"picture {side} {random.choice(modes)}" for side in wanted],
    )


def _rovers(random: Random) -> Drawn:
    rovers, spots, things = named("rover", 2), named("spot", 5), named("thing", 2)
    init = [f"at {each} {random.choice(spots)}" for each in rovers]
    init += [f"unloaded {each}" for each in rovers] + ["digs rover1", "films rover2"]
    init += roads("way", spots, random)
    soils = random.sample(spots, 2)
    init += [f"soil {each}" for each in soils] + [f"hears {each}" for each in spots[:2]]
    init += [f"shows {spot} {thing}" for thing in things for spot in random.sample(spots, 2)]
    goal = [f"told-soil {each}" for each in soils] + [f"told-film {each}" for each in things]
    return {"rover": rovers, "spot": spots, "thing": things}, init, goal


def _barman(random: Random) -> Drawn:
    hands, glasses = named("hand", 2), named("glass", 2)
    juices, drinks = named("juice", 3), named("cocktail", 2)
    vessels = [*glasses, "shaker1"]
    init = [f"free {each}" for each in hands]
    init += [fact for each in vessels for fact in (f"stands {each}", f"blank {each}")]
    for drink in drinks:
        first, second = random.sample(juices, 2)
        init += [f"first {drink} {first}", f"second {drink} {second}"]
    goal = [f"holds glass1 {random.choice(drinks)}", f"holds glass2 {random.choice(juices)}"]
    return (
        {"hand": hands, "glass": glasses, "shaker": ["shaker1"], "juice": juices, "mixed": drinks},
        init,
        goal,
    )


def _tyre(random: Random) -> Drawn:
    hubs = named("hub", random.choice((1, 2)))
    old = [f"old{number + 1}" for number in range(len(hubs))]
    new = [f"new{number + 1}" for number in range(len(hubs))]
    init = [f"stowed {each}" for each in [*new, "jack1", "wrench1", "pump1"]]
    init += [
        fact
        for hub, wheel in zip(hubs, old, strict=True)
        for fact in (f"on {wheel} {hub}", f"tight {hub}", f"down {hub}")
    ]
    init += ["shut boot1", *(f"flat {each}" for each in new)]
    goal = [
        fact
        for hub, wheel in zip(hubs, new, strict=True)
        for fact in (f"on {wheel} {hub}", f"tight {hub}", f"down {hub}", f"firm {wheel}")
    ]
    goal += [f"stowed {each}" for each in [*old, "jack1"]]
    objects = {"wheel": [*old, *new], "hub": hubs, "jack": ["jack1"], "wrench": ["wrench1"]}
    return objects | {"pump": ["pump1"], "boot": ["boot1"]}, init, goal


KINDS = {
    "satellite": Kind(
        "craft tool side mode",
        "(aboard ?t - tool ?c - craft) (takes ?t - tool ?m - mode) (target ?t - tool ?d - side) "
        "(faces ?c - craft ?d - side) (idle ?c - craft) (runs ?c - craft ?t - tool) "
        "(adjusted ?t - tool) (picture ?d - side ?m - mode)",
        (
            (
                "turn",
                "?c - craft ?from - side ?to - side",
                "(faces ?c ?from)",
                "(not (faces ?c ?from)) (faces ?c ?to)",
            ),
            (
                "start",
                "?t - tool ?c - craft",
                "(aboard ?t ?c) (idle ?c)",
                "(not (idle ?c)) (runs ?c ?t) (not (adjusted ?t))",
            ),
            (
                "stop",
                "?t - tool ?c - craft",
                "(runs ?c ?t)",
                "(not (runs ?c ?t)) (idle ?c)",
            ),
            (
                "adjust",
                "?t - tool ?c - craft ?d - side",
                "(runs ?c ?t) (target ?t ?d) (faces ?c ?d)",
                "(adjusted ?t)",
            ),
            (
                "photograph",
                "?t - tool ?c - craft ?d - side ?m - mode",
                "(runs ?c ?t) (adjusted ?t) (takes ?t ?m) (faces ?c ?d)",
                "(picture ?d ?m)",
            ),
        ),
        _satellite,
    ),
    "rovers": Kind(
        "rover spot thing",
        "(at ?r - rover ?s - spot) (way ?s - spot ?t - spot) (soil ?s - spot) (digs ?r - rover) "
        "(films ?r - rover) (shows ?s - spot ?x - thing) (hears ?s - spot) (unloaded ?r - rover) "
        "(sample ?r - rover ?s - spot) (film ?r - rover ?x - thing) (ready ?r - rover) "
        "(told-soil ?s - spot) (told-film ?x - thing)",
        (
            (
                "go",
                "?r - rover ?from - spot ?to - spot",
                "(at ?r ?from) (way ?from ?to)",
                "(not (at ?r ?from)) (at ?r ?to)",
            ),
            (
                "dig",
                "?r - rover ?s - spot",
                "(digs ?r) (at ?r ?s) (soil ?s) (unloaded ?r)",
                "(not (unloaded ?r)) (sample ?r ?s)",
            ),
            (
                "tip-out",
                "?r - rover ?s - spot",
                "(sample ?r ?s)",
                "(not (sample ?r ?s)) (unloaded ?r)",
            ),
            (
                "set-up",
                "?r - rover ?s - spot ?x - thing",
                "(films ?r) (at ?r ?s) (shows ?s ?x)",
                "(ready ?r)",
            ),
            (
                "shoot",
                "?r - rover ?s - spot ?x - thing",
                "(films ?r) (ready ?r) (at ?r ?s) (shows ?s ?x)",
                "(film ?r ?x) (not (ready ?r))",
            ),
            (
                "report-soil",
                "?r - rover ?s - spot ?here - spot",
                "(sample ?r ?s) (at ?r ?here) (hears ?here)",
                "(told-soil ?s)",
            ),
            (
                "report-film",
                "?r - rover ?x - thing ?here - spot",
                "(film ?r ?x) (at ?r ?here) (hears ?here)",
                "(told-film ?x)",
            ),
        ),
        _rovers,
    ),
    "barman": Kind(
        "hand glass shaker - vessel juice mixed - drink",
        "(free ?h - hand) (stands ?v - vessel) (held ?v - vessel ?h - hand) (blank ?v - vessel) "
        "(holds ?v - vessel ?d - drink) (half ?s - shaker ?j - juice) "
        "(first ?d - mixed ?j - juice) (second ?d - mixed ?j - juice)",
        (
            (
                "grasp",
                "?v - vessel ?h - hand",
                "(stands ?v) (free ?h)",
                "(not (stands ?v)) (not (free ?h)) (held ?v ?h)",
            ),
            (
                "put-down",
                "?v - vessel ?h - hand",
                "(held ?v ?h)",
                "(not (held ?v ?h)) (stands ?v) (free ?h)",
            ),
            (
                "fill",
                "?g - glass ?h - hand ?j - juice",
                "(held ?g ?h) (blank ?g)",
                "(not (blank ?g)) (holds ?g ?j)",
            ),
            (
                "empty",
                "?v - vessel ?h - hand ?d - drink",
                "(held ?v ?h) (holds ?v ?d)",
                "(not (holds ?v ?d)) (blank ?v)",
            ),
            (
                "empty-half",
                "?s - shaker ?h - hand ?j - juice",
                "(held ?s ?h) (half ?s ?j)",
                "(not (half ?s ?j)) (blank ?s)",
            ),
            (
                "pour-first",
                "?g - glass ?h - hand ?s - shaker ?j - juice",
                "(held ?g ?h) (holds ?g ?j) (blank ?s)",
                "(not (holds ?g ?j)) (blank ?g) (not (blank ?s)) (half ?s ?j)",
            ),
            (
                "pour-second",
                "?g - glass ?h - hand ?s - shaker ?i - juice ?j - juice ?d - mixed",
                "(held ?g ?h) (holds ?g ?j) (half ?s ?i) (first ?d ?i) (second ?d ?j)",
                "(not (holds ?g ?j)) (blank ?g) (not (half ?s ?i)) (holds ?s ?d)",
            ),
            (
                "serve",
                "?s - shaker ?h - hand ?g - glass ?d - mixed",
                "(held ?s ?h) (holds ?s ?d) (blank ?g)",
                "(not (holds ?s ?d)) (blank ?s) (not (blank ?g)) (holds ?g ?d)",
            ),
        ),
        _barman,
    ),
    "tyre": Kind(
        "wheel jack wrench pump - thing hub boot",
        "(stowed ?x - thing) (out ?x - thing) (shut ?b - boot) (open ?b - boot) "
        "(on ?w - wheel ?h - hub) (bare ?h - hub) (tight ?h - hub) (loose ?h - hub) "
        "(undone ?h - hub) (down ?h - hub) (up ?h - hub ?j - jack) (flat ?w - wheel) "
        "(firm ?w - wheel)",
        (
            ("open-boot", "?b - boot", "(shut ?b)", "(not (shut ?b)) (open ?b)"),
            ("shut-boot", "?b - boot", "(open ?b)", "(not (open ?b)) (shut ?b)"),
            (
                "fetch",
                "?x - thing ?b - boot",
                "(open ?b) (stowed ?x)",
                "(not (stowed ?x)) (out ?x)",
            ),
            ("stow", "?x - thing ?b - boot", "(open ?b) (out ?x)", "(not (out ?x)) (stowed ?x)"),
            (
                "inflate",
                "?w - wheel ?p - pump",
                "(out ?p) (out ?w) (flat ?w)",
                "(not (flat ?w)) (firm ?w)",
            ),
            (
                "loosen",
                "?h - hub ?w - wrench",
                "(out ?w) (tight ?h) (down ?h)",
                "(not (tight ?h)) (loose ?h)",
            ),
            (
                "tighten",
                "?h - hub ?w - wrench",
                "(out ?w) (loose ?h) (down ?h)",
                "(not (loose ?h)) (tight ?h)",
            ),
            (
                "lift",
                "?h - hub ?j - jack",
                "(out ?j) (down ?h)",
                "(not (out ?j)) (not (down ?h)) (up ?h ?j)",
            ),
            (
                "lower",
                "?h - hub ?j - jack",
                "(up ?h ?j)",
                "(not (up ?h ?j)) (out ?j) (down ?h)",
            ),
            (
                "undo",
                "?h - hub ?w - wrench ?j - jack",
                "(out ?w) (up ?h ?j) (loose ?h)",
                "(not (loose ?h)) (undone ?h)",
            ),
            (
                "do-up",
                "?h - hub ?w - wrench ?j - jack",
                "(out ?w) (up ?h ?j) (undone ?h)",
                "(not (undone ?h)) (loose ?h)",
            ),
            (
                "take-off",
                "?w - wheel ?h - hub ?j - jack",
                "(on ?w ?h) (up ?h ?j) (undone ?h)",
                "(not (on ?w ?h)) (bare ?h) (out ?w)",
            ),
            (
                "put-on",
                "?w - wheel ?h - hub ?j - jack",
                "(out ?w) (bare ?h) (up ?h ?j) (undone ?h)",
                "(not (out ?w)) (not (bare ?h)) (on ?w ?h)",
            ),
        ),
        _tyre,
    ),
}
"""Kinds by name."""
