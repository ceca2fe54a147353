"""The command line: words → calls, no logic of its own."""

from tpvqa.cli.app import main

__all__ = ["main"]
