"""Limits of address space, under that which this process was started with."""

import resource


def within(limit: int) -> int:
    """So many bytes, or what this process is held to, where that is less: none may ask for more."""
    _, highest = resource.getrlimit(resource.RLIMIT_AS)
    return limit if highest == resource.RLIM_INFINITY else min(limit, highest)
