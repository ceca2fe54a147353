"""A task → a questions file to edit: its names put into English, as far as names tell."""

from tpvqa.drafting.draft import LOOK, Words, draft, words

__all__ = ["LOOK", "Words", "draft", "words"]
