"""Pictures as the paper got them: photos, variations of photos, and pictures from prompts."""
