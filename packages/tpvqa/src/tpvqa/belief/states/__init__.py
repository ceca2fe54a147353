"""Which states there may be: what can hold together, be reached, come undone."""
