"""Screw feeder of the study `screw`: the script that draws it."""
