"""Figures of the case equipment, drawn from its tables and surfaces."""
