"""VLMs side by side: what each answers about one labelled set, and how they differ."""
