"""Geometry builders: plain SI arguments in, a `SurfaceMesh` out."""
