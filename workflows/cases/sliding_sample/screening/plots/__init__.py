"""Figures of screening studies: the only place of them that draws."""
