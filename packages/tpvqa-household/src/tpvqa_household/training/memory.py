"""How the C library treats freed memory."""

import ctypes


def keep_memory() -> None:
    """Let glibc keep freed memory: a third of a step was the kernel clearing fresh pages."""
    try:
        libc = ctypes.CDLL("libc.so.6")
        libc.mallopt(-4, 0)  # M_MMAP_MAX: no mappings of their own for large blocks
        libc.mallopt(-1, 2**31 - 1)  # M_TRIM_THRESHOLD
    except (OSError, AttributeError):
        pass
