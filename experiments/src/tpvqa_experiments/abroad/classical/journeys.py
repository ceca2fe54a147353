"""Kinds in which things are brought to places."""

from random import Random

from tpvqa_experiments.abroad.classical.kind import Drawn, Kind, chain, named, roads


def _zenotravel(random: Random) -> Drawn:
    planes, people = named("plane", 2), named("person", 4)
    cities, levels = named("city", 4), named("level", 4)
    init = [f"at {each} {random.choice(cities)}" for each in planes + people]
    init += [f"fuel {each} {random.choice(levels)}" for each in planes]
    init += chain("less", levels)
    goal = [f"at {each} {random.choice(cities)}" for each in people]
    return {"plane": planes, "person": people, "city": cities, "level": levels}, init, goal


def _driverlog(random: Random) -> Drawn:
    drivers, vans = named("driver", 2), named("van", 2)
    parcels, places = named("parcel", 3), named("place", 4)
    init = [f"at {each} {random.choice(places)}" for each in drivers + vans + parcels]
    init += [f"empty {each}" for each in vans]
    init += roads("road", places, random) + roads("path", places, random)
    goal = [f"at {each} {random.choice(places)}" for each in [*parcels, drivers[0]]]
    return {"driver": drivers, "van": vans, "parcel": parcels, "place": places}, init, goal


def _transport(random: Random) -> Drawn:
    lorries, boxes = named("lorry", 2), named("box", 4)
    towns, racks = named("town", 5), named("rack", 4)
    init = [f"at {each} {random.choice(towns)}" for each in lorries + boxes]
    init += [f"free {each}" for each in racks]
    init += [f"part {rack} {lorries[number % 2]}" for number, rack in enumerate(racks)]
    init += roads("road", towns, random)
    goal = [f"at {each} {random.choice(towns)}" for each in boxes]
    return {"lorry": lorries, "box": boxes, "town": towns, "rack": racks}, init, goal


KINDS = {
    "zenotravel": Kind(
        "plane person - mobile city level",
        "(at ?x - mobile ?c - city) (in ?p - person ?a - plane) (fuel ?a - plane ?l - level) "
        "(less ?l - level ?m - level)",
        (
            (
                "board",
                "?p - person ?a - plane ?c - city",
                "(at ?p ?c) (at ?a ?c)",
                "(not (at ?p ?c)) (in ?p ?a)",
            ),
            (
                "alight",
                "?p - person ?a - plane ?c - city",
                "(in ?p ?a) (at ?a ?c)",
                "(not (in ?p ?a)) (at ?p ?c)",
            ),
            (
                "fly",
                "?a - plane ?from - city ?to - city ?full - level ?low - level",
                "(at ?a ?from) (fuel ?a ?full) (less ?low ?full)",
                "(not (at ?a ?from)) (at ?a ?to) (not (fuel ?a ?full)) (fuel ?a ?low)",
            ),
            (
                "refuel",
                "?a - plane ?low - level ?full - level",
                "(fuel ?a ?low) (less ?low ?full)",
                "(not (fuel ?a ?low)) (fuel ?a ?full)",
            ),
        ),
        _zenotravel,
    ),
    "driverlog": Kind(
        "driver van parcel - mobile place",
        "(at ?x - mobile ?p - place) (in ?x - parcel ?v - van) (driving ?d - driver ?v - van) "
        "(empty ?v - van) (road ?p - place ?q - place) (path ?p - place ?q - place)",
        (
            (
                "load",
                "?x - parcel ?v - van ?p - place",
                "(at ?x ?p) (at ?v ?p)",
                "(not (at ?x ?p)) (in ?x ?v)",
            ),
            (
                "unload",
                "?x - parcel ?v - van ?p - place",
                "(in ?x ?v) (at ?v ?p)",
                "(not (in ?x ?v)) (at ?x ?p)",
            ),
            (
                "enter",
                "?d - driver ?v - van ?p - place",
                "(at ?d ?p) (at ?v ?p) (empty ?v)",
                "(not (at ?d ?p)) (not (empty ?v)) (driving ?d ?v)",
            ),
            (
                "leave",
                "?d - driver ?v - van ?p - place",
                "(driving ?d ?v) (at ?v ?p)",
                "(not (driving ?d ?v)) (empty ?v) (at ?d ?p)",
            ),
            (
                "drive",
                "?d - driver ?v - van ?from - place ?to - place",
                "(driving ?d ?v) (at ?v ?from) (road ?from ?to)",
                "(not (at ?v ?from)) (at ?v ?to)",
            ),
            (
                "walk",
                "?d - driver ?from - place ?to - place",
                "(at ?d ?from) (path ?from ?to)",
                "(not (at ?d ?from)) (at ?d ?to)",
            ),
        ),
        _driverlog,
    ),
    "transport": Kind(
        "lorry box - mobile town rack",
        "(at ?x - mobile ?t - town) (in ?b - box ?r - rack) (free ?r - rack) "
        "(part ?r - rack ?l - lorry) (road ?t - town ?u - town)",
        (
            (
                "drive",
                "?l - lorry ?from - town ?to - town",
                "(at ?l ?from) (road ?from ?to)",
                "(not (at ?l ?from)) (at ?l ?to)",
            ),
            (
                "load",
                "?b - box ?l - lorry ?r - rack ?t - town",
                "(at ?b ?t) (at ?l ?t) (part ?r ?l) (free ?r)",
                "(not (at ?b ?t)) (not (free ?r)) (in ?b ?r)",
            ),
            (
                "unload",
                "?b - box ?l - lorry ?r - rack ?t - town",
                "(in ?b ?r) (part ?r ?l) (at ?l ?t)",
                "(not (in ?b ?r)) (free ?r) (at ?b ?t)",
            ),
        ),
        _transport,
    ),
}
"""Kinds by name."""
