"""Carries out actions for PlanSys2, and reports success where pictures bear it out."""
