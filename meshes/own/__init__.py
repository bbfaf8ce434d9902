"""Surfaces of a plant's own: CAD and mesh files read, mended, checked and refined for the solver."""
