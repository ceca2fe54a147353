"""A trial on the toys' table as a film."""
