"""Logic programs (answer set programming) as tasks: read, grounded, and written as PDDL."""
