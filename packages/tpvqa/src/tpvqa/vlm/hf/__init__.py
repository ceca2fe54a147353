"""Local models of the transformers library: ViLT, BLIP, and chat models that take pictures."""
