"""The command line: words → calls, no logic of its own."""

import sys

__all__ = ["main"]


def main() -> None:
    """Run the command line; see `tpvqa.cli.app.main`. Ctrl-C while it is loaded ends it, too."""
    try:
        from tpvqa.cli.app import main as run
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        sys.exit(130)
    run()
