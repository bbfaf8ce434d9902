"""Tumbling mill of the study `mill`: the script that draws it."""
