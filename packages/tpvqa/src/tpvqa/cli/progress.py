"""A bar with rate and time left, on standard error."""


class CountBar:
    """Shows how many of how many are done. Use it as a context manager.

    Attributes:
        what: What is counted.
    """

    def __init__(self, what: str = "episodes"):
        self.what = what

    def __enter__(self) -> "CountBar":
        from rich.console import Console
        from rich.progress import (
            BarColumn,
            MofNCompleteColumn,
            Progress,
            TextColumn,
            TimeElapsedColumn,
            TimeRemainingColumn,
        )

        self._bar = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("{task.fields[rate]}"),
            TimeElapsedColumn(),
            TextColumn("left"),
            TimeRemainingColumn(),
            console=Console(stderr=True),
        )
        self._task = self._bar.add_task(self.what, total=None, rate="")
        self._first: int | None = None
        return self

    def __call__(self, done: int, total: int) -> None:
        """Show how far it is."""
        self._bar.start()  # not before: what is wrong with the input is told without a bar
        if self._first is None:
            self._first = done
        elapsed = self._bar.tasks[0].elapsed or 0.0
        rate = (done - self._first) / elapsed if elapsed > 0.5 else 0.0
        self._bar.update(
            self._task, completed=done, total=total, rate=f"{rate:.0f}/s" if rate else ""
        )

    def count(self, what: str) -> None:
        """Count something else from here on."""
        self.what, self._first = what, None
        self._bar.reset(self._task, total=None, description=what, rate="")

    def __exit__(self, *_: object) -> None:
        self._bar.stop()
