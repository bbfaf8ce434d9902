"""Scans of worn surfaces: where a cloud lies, its registration by what did not wear, comparison."""
