"""A task → a questions file to edit: its names put into English, as far as names tell."""

from tpvqa.drafting.draft import draft

__all__ = ["draft"]
