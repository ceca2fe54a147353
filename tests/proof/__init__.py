"""That a trial comes out as before: what sixty trials decided, asked, did and came to, kept."""
