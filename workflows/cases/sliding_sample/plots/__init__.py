"""Figures of sliding samples: the only place of the case that draws, besides those of its studies."""
