"""Readers of what LIGGGHTS writes: contact dumps, log files and loads per triangle."""
