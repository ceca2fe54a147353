"""Labelled pictures → a VLM that was trained on them, with figures on those held back."""
