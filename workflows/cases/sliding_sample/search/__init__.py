"""Searches for the pattern of least wear: what comes next, what was tried, the best pattern beside others."""
