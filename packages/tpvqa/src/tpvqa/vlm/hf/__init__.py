"""Local models of the transformers library as the VLM: ViLT, BLIP, and chat models with pictures."""
