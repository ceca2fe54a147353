"""Labelled answers → calibrations, and what else is counted beforehand."""
