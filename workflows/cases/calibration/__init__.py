"""Contact parameters calibrated on bulk tests: everything of the case."""
