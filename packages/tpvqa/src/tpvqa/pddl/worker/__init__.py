"""The process in which Fast Downward's translator runs (`python -m tpvqa.pddl.worker`).

The translator is GPL, keeps global state and prints. So nothing of it is ever imported into the
process of the package: this one reads PDDL, grounds, keeps the grounding and starts the search,
and is talked to by pipes (see `tpvqa.pddl.processes`).
"""
