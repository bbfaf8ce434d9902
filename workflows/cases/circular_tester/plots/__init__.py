"""Figures of the circular wear tester, drawn from its tables."""
