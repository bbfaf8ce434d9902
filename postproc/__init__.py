"""Wear post-processing: surface mesh, readers, wear, analysis and plots."""
