"""English that names in PDDL are made of: what each word is, and how verbs go."""


def word_set(words: str) -> frozenset[str]:
    """The words of a text."""
    return frozenset(words.split())


PREPOSITIONS = word_set(
    "above across against along around at atop before behind below beneath beside between by "
    "for from in inside into near of off on onto outside over through to toward towards under "
    "underneath upon with within"
)
PLACING = word_set(
    "above against at behind below beneath beside in inside into near on onto over to under "
    "underneath upon"
)
"""Prepositions behind which a thing stands that is there: on the stand."""
PARTICLES = word_set("away back down in off on open out over shut together up")
"""What follows a verb as a part of it: pick up, switch on, put back."""

AGENTS = word_set(
    "agent agv arm astronaut car chef cook crane craft doctor driver drone ferry forklift "
    "gripper hand hands helicopter hoist human lift lorry manipulator miner nurse operator "
    "passenger person plane airplane aeroplane aircraft player pilot robby robot rover "
    "satellite ship taxi technician train truck tug van vehicle waiter worker rov auv uav ugv"
)
"""What acts, or is where it is by itself."""
PEOPLE = word_set(
    "agent astronaut chef cook doctor driver drone human miner nurse operator passenger person "
    "player pilot robby robot rover technician waiter worker rov auv uav ugv"
)
"""Agents that are made to do something: have driver 1 walk."""
HANDS = word_set("arm claw effector gripper hand hands jaws manipulator fingers")
PERSONS = word_set(
    "person human patient man woman child customer guest employee resident actor actress dancer "
    "singer musician student pupil boy girl friend visitor neighbour neighbor"
)
"""Who has a name of their own."""
COLOURS = word_set("color colour paint")
"""What a thing is painted, without an article."""
PARTS_OF_ROBOTS = HANDS | {"flange", "wrist", "battery", "camera"}

INSIDE = word_set(
    "area aisle bag bakery basin basket bath bathroom bay bedroom bin boat boot bottle bowl box "
    "bucket building cabinet cage carton cart cell chest city closet compartment container "
    "corridor cup cupboard district dishwasher drawer fridge freezer garage garden glass "
    "greenhouse hall hallway house kitchen lab lane locker mug office oven pan pantry park pot "
    "refrigerator region rack room safe shaker shop shower sink slot space spool store town "
    "trash truck van vase vessel vice ward wardrobe warehouse waste well yard zone machine "
    "microwave holder elevator lift car lorry plane airplane aircraft cold cellar barn shed attic "
    "vault chamber studio cabin loft basement hangar"
)
"""What things are in."""
UPON = word_set(
    "bed bench board carpet ceiling chair conveyor counter couch cube desk disc disk dish door "
    "floor gear ground hook layer lid mat pallet pedestal peg pile plate platform rail road "
    "roof seat shelf siding sofa spike stack stairs stand stool stove surface table tile tower "
    "tray track wall worktop crossing"
)
"""What things are on."""
PLACES = word_set(
    "airport cell city corner depot destination district dock floor goal home junction loc "
    "location node place point port pos position room site spot station stop target tile town "
    "village waypoint zone distributor wharf field gate base house hospital school space area "
    "rendezvous slot side track siding"
)
GENERIC = word_set(
    "object obj thing item default static moveable movable mobile locatable entity element "
    "stuff physobj physical any none type something things objects unit"
)
"""Kinds that say nothing of what a thing is."""

ADJECTIVES = word_set(
    "active adjacent airborne alive armed asleep available awake aboard bare big black blank "
    "blocked blue bright broken brown busy charged clean clear closed cold complete cool "
    "correct damaged damp dark dead deep defective dirty docked done dry dull dusty early easy "
    "empty even fine firm first fit flat free fresh frozen full green grey gray hard healthy "
    "heavy high hollow home hot hungry idle ill inactive intact jammed large late left level "
    "light lit live locked loose lost low lower missing moist naked narrow new occupied odd off "
    "offline ok old on online open operational opposite out own pink plain powered present "
    "public purple quick ready red rear right ripe rotten rough round safe sealed second secure "
    "shallow sharp short shut sick slow small smooth soft soiled solid spare stable steep "
    "sticky stale straight strong stuck tall thick thin tidy tight tired top upper upright "
    "upside used vacant valid visible wake warm weak wet whole wide wrong yellow young white "
    "orange front bottom middle raw unlocked unloaded unsafe undone nearby north south east "
    "west"
)
PARTS = word_set(
    "lid cap cover label handle wheel door plug seal stopper barcode button switch knob hatch "
    "nozzle valve filter battery screen latch bell doorbell"
)
"""What a thing may have or lack."""
BARE = word_set(
    "foot hand board place line order half time hold bed power fire gear rest home reverse motion "
    "use stock focus sync tune view sight tow transit tension position service bloom season "
    "contact reach duty control pressure progress operation danger standby flight storage orbit "
    "charge work alert"
)
"""What goes without an article behind a preposition: on foot, in half, in focus."""
TOOLS = word_set(
    "tool wrench spanner hammer plier pliers shears scissors knife screwdriver driver drill saw "
    "tape tongs tweezers clamp key brush sponge cloth rope strap torch crowbar lever"
)
"""What something is done with."""
UNSEEN = word_set(
    "ok okay cleared screened unscreened approved verified validated authorised authorized "
    "scheduled reserved registered known checked inspected metered measured calibrated tested "
    "sampled sterile sterilised sterilized disinfected contaminated infected diseased healthy ill "
    "tired hungry hot warm cold cool charged powered energised energized primed valid safe unsafe "
    "paid booked assigned retired rebuilt faulty encoded coded recorded reported informed heavy "
    "fed watered dosed medicated vaccinated exposed photographed sketched scanned sampled weighed "
    "greeted visited explored listened heard read learnt learned counted smelt tasted notified rung"
)
"""What a picture seldom shows."""
SIDES = word_set(
    "left right upper lower front rear top bottom middle first second third north south east "
    "west red blue green yellow black white grey gray brown orange purple pink cyan magenta big "
    "small up down large long short tall old new cold hot near far inner outer"
)
"""Words that are names only together with what they say something of: the left lamp."""
DEGREES = word_set("almost half halfway already still semi well over self not very quite")
"""How far, or how, something is so, beside words in -ly."""
NO_ADVERBS = word_set("assembly belly family fly jelly ply supply level light spare")
"""Things, though they look like words that say how."""

IRREGULAR = {
    "be": ("was", "been"), "become": ("became", "become"), "begin": ("began", "begun"),
    "bend": ("bent", "bent"), "bind": ("bound", "bound"), "bleed": ("bled", "bled"),
    "blow": ("blew", "blown"), "break": ("broke", "broken"), "bring": ("brought", "brought"),
    "build": ("built", "built"), "burn": ("burnt", "burnt"), "burst": ("burst", "burst"),
    "buy": ("bought", "bought"), "cast": ("cast", "cast"), "catch": ("caught", "caught"),
    "choose": ("chose", "chosen"), "come": ("came", "come"), "cut": ("cut", "cut"),
    "dig": ("dug", "dug"), "do": ("did", "done"), "draw": ("drew", "drawn"),
    "drink": ("drank", "drunk"), "drive": ("drove", "driven"), "eat": ("ate", "eaten"),
    "fall": ("fell", "fallen"), "feed": ("fed", "fed"), "find": ("found", "found"),
    "flee": ("fled", "fled"), "fling": ("flung", "flung"), "fly": ("flew", "flown"),
    "freeze": ("froze", "frozen"), "get": ("got", "got"), "give": ("gave", "given"),
    "go": ("went", "gone"), "grind": ("ground", "ground"), "grow": ("grew", "grown"),
    "hang": ("hung", "hung"), "have": ("had", "had"), "hear": ("heard", "heard"),
    "hide": ("hid", "hidden"), "hit": ("hit", "hit"), "hold": ("held", "held"),
    "hurt": ("hurt", "hurt"), "keep": ("kept", "kept"), "kneel": ("knelt", "knelt"),
    "know": ("knew", "known"), "lay": ("laid", "laid"), "lead": ("led", "led"),
    "leave": ("left", "left"), "lend": ("lent", "lent"), "let": ("let", "let"),
    "lie": ("lay", "lain"), "light": ("lit", "lit"), "lose": ("lost", "lost"),
    "make": ("made", "made"), "mean": ("meant", "meant"), "meet": ("met", "met"),
    "override": ("overrode", "overridden"), "overtake": ("overtook", "overtaken"),
    "overwrite": ("overwrote", "overwritten"), "pay": ("paid", "paid"),
    "preset": ("preset", "preset"), "put": ("put", "put"), "quit": ("quit", "quit"),
    "read": ("read", "read"), "rebuild": ("rebuilt", "rebuilt"), "redo": ("redid", "redone"),
    "regrind": ("reground", "reground"), "rehang": ("rehung", "rehung"),
    "relight": ("relit", "relit"), "remake": ("remade", "remade"), "reread": ("reread", "reread"),
    "rerun": ("reran", "rerun"), "resend": ("resent", "resent"), "reset": ("reset", "reset"),
    "retake": ("retook", "retaken"), "rewind": ("rewound", "rewound"),
    "rewrite": ("rewrote", "rewritten"), "ride": ("rode", "ridden"), "ring": ("rang", "rung"),
    "rise": ("rose", "risen"), "run": ("ran", "run"), "saw": ("sawed", "sawn"),
    "say": ("said", "said"), "see": ("saw", "seen"), "seek": ("sought", "sought"),
    "sell": ("sold", "sold"), "send": ("sent", "sent"), "set": ("set", "set"),
    "sew": ("sewed", "sewn"), "shake": ("shook", "shaken"), "shear": ("sheared", "shorn"),
    "shine": ("shone", "shone"), "shoot": ("shot", "shot"), "show": ("showed", "shown"),
    "shrink": ("shrank", "shrunk"), "shut": ("shut", "shut"), "sing": ("sang", "sung"),
    "sit": ("sat", "sat"), "sleep": ("slept", "slept"), "slide": ("slid", "slid"),
    "slit": ("slit", "slit"), "sow": ("sowed", "sown"), "speak": ("spoke", "spoken"),
    "spend": ("spent", "spent"), "spin": ("spun", "spun"), "split": ("split", "split"),
    "spread": ("spread", "spread"), "stand": ("stood", "stood"), "steal": ("stole", "stolen"),
    "stick": ("stuck", "stuck"), "strew": ("strewed", "strewn"), "strike": ("struck", "struck"),
    "sweep": ("swept", "swept"), "swell": ("swelled", "swollen"), "swim": ("swam", "swum"),
    "swing": ("swung", "swung"), "take": ("took", "taken"), "teach": ("taught", "taught"),
    "tear": ("tore", "torn"), "tell": ("told", "told"), "throw": ("threw", "thrown"),
    "unbind": ("unbound", "unbound"), "understand": ("understood", "understood"),
    "undo": ("undid", "undone"), "unfreeze": ("unfroze", "unfrozen"),
    "unstick": ("unstuck", "unstuck"), "unwind": ("unwound", "unwound"), "wake": ("woke", "woken"),
    "wear": ("wore", "worn"), "weave": ("wove", "woven"), "win": ("won", "won"),
    "wind": ("wound", "wound"), "withdraw": ("withdrew", "withdrawn"),
    "withhold": ("withheld", "withheld"), "wring": ("wrung", "wrung"),
    "write": ("wrote", "written"),
}  # fmt: skip
REGULAR = word_set(
    "achieve add adjust align arrive assemble assign attach bake bathe beat board boil bore "
    "brew call calibrate carry change charge check clamp clean clear climb close collect "
    "compute connect contain cook cool cover crop cross damage deburr debark declare deliver "
    "depart destroy detach dial dip dirty disassemble discard disconnect disinfect dismount "
    "dissolve dock drain dress drill drop dry dust embark empty enter erase escape examine "
    "expand explode extinguish face fasten fetch fill finish fit fix flip float fold follow fry "
    "glaze glue grab grasp grease greet grill handle harvest heat help hoist image include "
    "indicate infect inflate inform insert inspect install iron join jump kick kill knock label "
    "land launch leak lean lift like link load locate lock look loosen lower lubricate map "
    "mark mash measure melt mend mill miss mix mop mount move navigate need nest observe occupy "
    "open operate order pack paint park pass paste peel pick pin pile place plan plant play "
    "plug point polish pour power prepare press price print process protect pull pump punch "
    "push rack raise rake reach record refill refuel release remove rename repair replace "
    "report require restore retract return rinse roast rotate sail salt sample save scan "
    "scatter scrub seal season serve sharpen shave shelve ship slice smash soak solve sort "
    "spray squeeze stack stain staple start starve stay sterilise sterilize stir stock stop "
    "store stow strap stretch supply support switch tag talk tap taste tear test tie tighten "
    "tip toast toggle touch tow track transfer transmit transport travel treat trim turn type "
    "uncap unclamp uncover unlatch unload unlock unplug unpack unscrew unstack unwrap update "
    "use vacuum verify visit wait walk warm wash watch water weigh weld whisk wipe work wrap "
    "yield zip activate deactivate approach assist authorise authorize avoid borrow bury "
    "communicate cooperate cultivate cure decorate dispatch dispense dispose document dump "
    "enable equip evacuate exchange excavate execute explore fertilise fertilize fire flush "
    "generate guide hammer hand identify ignite illuminate interact isolate latch mow nail "
    "nudge perch photograph plate position pollinate prune purchase queue radio receive "
    "recharge recycle relocate rescue reserve route sand scoop screw search secure separate "
    "shift shred sign smell spill steer sweeten tidy trace train trap triage undock unfold "
    "unhook unmount untie validate wet withdraw hitch unhitch gather stuff tumble extract clip "
    "unclip poll eject crimp solder pipette decant aspirate incubate stopper dilute sift "
    "sieve haul drag tether untether rivet deploy dose bolt unbolt grapple convey escort shuttle "
    "aim brace coil dim drape engage expose fuse net oil pry puff sketch slew smoke swab "
    "thaw invert homogenise homogenize agitate swirl chill preheat reheat refrigerate simmer "
    "knead whip grate chop mince marinate garnish strain blend defrost hydrate rehydrate "
    "moisten sanitise sanitize pasteurise pasteurize inoculate irrigate evaporate titrate "
    "energise energize magnetise magnetize demagnetise demagnetize desolder unsolder rewire "
    "splice hone burnish anneal quench etch engrave emboss stamp sandblast varnish prime coat "
    "laminate bond caulk grout recalibrate realign readjust tune retune pressurise pressurize "
    "depressurise depressurize vent purge accelerate decelerate halt pause resume abort "
    "initialise initialize reboot restart reload reinsert reattach reconnect remount reopen "
    "reseal retighten reposition orient reorient pivot swivel twist untwist wiggle hover moor "
    "unmoor elevate ascend descend roll unroll detect hook settle palletise palletize bundle "
    "relabel restock replenish allocate accept reject approve confirm cancel acknowledge notify "
    "warn announce wave nod invite usher accompany chase intercept patrol survey sense "
    "recognise recognize classify compare diagnose assess plough weed mulch sprinkle transplant "
    "groom launder bleach scour scrape blot ventilate unfurl bandage suture inject sedate "
    "intubate administer massage undress jettison download upload synchronise synchronize cap "
    "dislodge unjam unblock unstrap unbox degrease descale defog retrieve untangle rescan "
    "reprint redeploy humidify dehumidify swap demount snip skim pluck reap thresh leash "
    "unleash uncrate sear vend"
)
"""Base forms of regular verbs."""
DOUBLED = word_set("dial equip patrol transfer")
"""Of these, those of two syllables that double their last letter: equipped."""

INTRANSITIVE = word_set(
    "arrive board depart escape explode fall fly go land leave move rise sail travel walk "
    "embark debark alight climb enter swim jump evacuate rot stop melt"
)
"""Verbs of which "has … -ed" is said of who did it, where only one thing is spoken of."""
ALONE = word_set(
    "run spin rotate revolve burn boil leak drip ring flash blink glow smoke float overheat hum "
    "idle vibrate"
)
"""Verbs of which "is … -ing" is said of the thing, where only one is spoken of."""
STATES = word_set(
    "open close shut lock unlock hold mount break cut light clamp cover fill fold switch turn "
    "toggle plug connect attach tie park place stack load insert charge clog seal unseal screw "
    "fasten tighten loosen set occupy soil stain contaminate wrap hang tilt raise lower dock "
    "jam stick align activate deactivate power stow rack assemble detach disconnect unplug "
    "unload freeze hide block damage clear fit assign protect carry grasp grip pack join link "
    "include lift nest lay pile spread slice peel halve undo bind unclamp unfold pin zip bend "
    "tear split crack dent wet flood arrange sort locate position lose"
)
"""Verbs whose participle names what can be seen of a thing: it is cut, it is locked."""
POSTURES = word_set("lie stand sit hang rest lean stay")
DIRECTED = word_set("aim point direct look face focus gaze steer orient")
"""What is done at a thing from elsewhere, wherever one would stand with it."""
STATIVE = word_set(
    "belong contain cost exist fit have know like mean need own require want love work match "
    "depend hold cover support touch block"
)
"""Verbs that are asked about with "does"; of the others "is … -ing" is said."""

TAKES = {
    "insert": "in", "plug": "into", "screw": "into", "load": "in", "pack": "in", "put": "in",
    "connect": "to", "attach": "to", "link": "to", "join": "to", "tie": "to", "fix": "to",
    "fasten": "to", "glue": "to", "clamp": "in", "assign": "to", "deliver": "to", "send": "to",
    "mount": "on", "stack": "on", "place": "at", "park": "at", "dock": "at", "store": "in",
    "cover": "with", "fill": "with", "wrap": "in", "mix": "with", "align": "with", "charge": "at",
    "paint": "", "dye": "", "label": "as", "hang": "on", "pin": "to", "serve": "to", "give": "to",
    "hide": "in", "nest": "in", "bury": "in", "transmit": "to", "communicate": "to",
    "transport": "to", "move": "to", "carry": "by", "hold": "by", "grasp": "by", "lift": "by",
    "use": "by", "grip": "by", "locate": "at", "position": "at", "pile": "on", "lay": "on",
    "set": "in", "spread": "on", "pour": "into", "wash": "in", "rack": "in", "scan": "by",
    "tell": "to", "report": "to", "hitch": "to", "tether": "to", "hook": "to", "bolt": "to",
    "clip": "to", "couple": "to", "cable": "to", "coat": "with",
}  # fmt: skip
"""What joins a participle to a second thing: inserted in, connected to."""

RUN_TOGETHER = word_set(
    "hand hands arm gripper table floor ground room door water food home bed top box goal hill "
    "trail block shelf free empty full busy clear clean open closed holding carrying moving up "
    "down drop off on in at to is has have not get go move pick put place turn switch lit light "
    "prize robot casino player key pawn bear monkey rock agent peg wood boat grass log bag bus "
    "train car plane person wall image crate area station"
)
"""Words that are written in one without a sign between them: handempty, ontable."""

COMPOUNDS = word_set(
    "bedside boxcar doorstep doorway floorboard foodstuff hilltop roommate tabletop treetop "
    "waterway"
)
"""Words that are one, though both their parts are words, too."""

ENDINGS = ("able", "ful", "less", "ible", "tight", "proof")
"""How words end that say what a thing is like."""
ABBREVIATIONS = {
    "loc": "location", "obj": "object", "pos": "position", "dest": "destination",
    "destin": "destination", "conn": "connected", "dir": "direction", "inhand": "in hand",
    "pkg": "package", "wp": "waypoint", "num": "number", "temp": "temperature",
    "grasped": "grasped", "eq": "equal", "rob": "robot", "msg": "message", "img": "image",
    "cont": "container", "veh": "vehicle", "pass": "pass",
}  # fmt: skip
SEVERAL = word_set("children feet geese men mice people teeth women")
"""Several things, without an s."""
MASS = word_set(
    "water milk coffee tea juice food soil sugar sand liquid fuel dust rubbish trash dirt money "
    "power energy rice flour salt oil soap ink glue grease algae mud snow ice rust moss foam mould "
    "grime wax honey smoke steam sauce dough dew frost blood"
)
"""What is not counted: any water, not a water."""
SWITCHED = word_set(
    "light lights lamp stove oven tv television power heating fan machine engine burner tap "
    "alarm radio motor pump heater breaker bus conveyor laser spindle vacuum mixer blower "
    "compressor torch projector beacon siren"
)
"""What is on or off by itself."""
PLURAL_EXCEPTIONS = word_set(
    "glass gas bus lens cross class press compass chassis canvas atlas bass mass grass brass "
    "dress mattress address boss iris cactus focus virus status bias kiss moss process success "
    "princess progress stress bypass cutlass harness fortress wilderness campus tennis plus "
    "series axis apparatus basis always this us his yes news physics mathematics athletics "
    "gymnastics chaos christmas means species biceps triceps cosmos thermos alias measles mumps"
)
