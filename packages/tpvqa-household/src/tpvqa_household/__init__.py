"""The household of tpvqa: tasks, pictures, a network that answers about them, a MuJoCo kitchen.

It plugs into tpvqa by entry points, as any package can.
"""

DISTRIBUTION = "tpvqa-household"
"""What pip calls it."""
