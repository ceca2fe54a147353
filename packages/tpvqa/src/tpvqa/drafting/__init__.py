"""A task → a questions file to edit: its names put into English, as far as names tell."""

from tpvqa.drafting.draft import Words, draft, words

__all__ = ["Words", "draft", "words"]
