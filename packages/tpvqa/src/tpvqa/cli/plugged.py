"""The commands of other packages.

A package offers commands by an entry point in the group `tpvqa.commands`: a function that is given
a `typer.Typer` and adds its commands to it. It is imported and called when all commands are listed,
or one is asked for that is not among tpvqa's own; so its module imports late what they need. What
is broken in one package leaves the commands of the others as they are.
"""

from collections.abc import MutableMapping
from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup

from tpvqa.cli.saying import tell
from tpvqa.distributions import remedy
from tpvqa.errors import PluginError, TpvqaError, UnknownNameError
from tpvqa.plugins import Kind, load, names

Command = Any
"""Typer's, which are those of Click or of its copy of Click."""


class PluggedGroup(TyperGroup):
    """The commands of this package, and after them those of others."""

    _plugged = False
    _broken: dict[str, TpvqaError]

    def get_command(self, ctx: Any, cmd_name: str) -> Command:
        """A command; of another package only where there is none of this one, or parts of a group.

        Raises:
            PluginError: It is broken.
            UnknownNameError: A package that has it is not installed.
        """
        if not isinstance(self.commands.get(cmd_name), TyperCommand):
            self._plug()
        found = super().get_command(ctx, cmd_name)
        if found is None:
            if cmd_name in self._broken:
                raise self._broken[cmd_name]
            if what := remedy("command", cmd_name):
                raise UnknownNameError("command", cmd_name, self.commands, remedy=what)
            self._say_what_is_broken()
        return found

    def list_commands(self, ctx: Any) -> list[str]:
        """The names of all commands; packages that are broken are named on standard error."""
        self._plug()
        self._say_what_is_broken()
        return super().list_commands(ctx)

    def _say_what_is_broken(self) -> None:
        for error in self._broken.values():
            tell(f"note: some commands are missing. {error}", error=True)

    def _plug(self) -> None:
        if self._plugged:
            return
        self._plugged, self._broken = True, {}
        for name in names(Kind.COMMANDS):
            try:
                twice = _add(_commands_of(name), self.commands)
            except TpvqaError as error:
                self._broken[name] = error
            else:
                if twice:
                    self._broken[name] = PluginError(
                        f"The commands {name!r} hold {', '.join(twice)}, of which there is one "
                        "already. Uninstall one of the packages."
                    )


class PartGroup(TyperGroup):
    """A group of commands to which other packages add theirs."""

    def get_command(self, ctx: Any, cmd_name: str) -> Command:
        """A command of the group.

        Raises:
            UnknownNameError: A package that has it is not installed.
        """
        found = super().get_command(ctx, cmd_name)
        if found is None and (what := remedy("command", f"{self.name} {cmd_name}")):
            raise UnknownNameError("command", f"{self.name} {cmd_name}", self.commands, remedy=what)
        return found


def _commands_of(name: str) -> dict[str, Command]:
    """What stands behind an entry point adds.

    Raises:
        TpvqaError: It cannot be imported, or broke.
    """
    register = load(Kind.COMMANDS, name)
    app = typer.Typer()
    try:
        register(app)
        return dict(typer.main.get_group(app).commands)
    except Exception as error:
        raise PluginError(f"The commands {name!r} broke: {error!r}.") from error


def _add(more: dict[str, Command], commands: MutableMapping[str, Command]) -> list[str]:
    """Add commands, and to groups of the same name their parts; gives what was there already."""
    twice = []
    for name, command in more.items():
        there = commands.setdefault(name, command)
        if there is command:
            continue
        if isinstance(there, TyperGroup) and isinstance(command, TyperGroup):
            parts = _add(dict(command.commands), there.commands)
            twice += [f"{name} {part}" for part in parts]
        else:
            twice.append(name)
    return twice
