"""What each choice is expected to cost, and what is asked beforehand."""
