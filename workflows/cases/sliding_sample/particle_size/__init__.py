"""Particle size: wear against particle scale, packings, single contacts."""
