"""Searches for the pattern of least wear: what comes next, the record of what was tried, the best pattern beside others."""
