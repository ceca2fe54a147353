"""`python -m tpvqa`."""

from tpvqa.cli import main

main()
