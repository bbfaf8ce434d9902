"""Figures of particle size."""
