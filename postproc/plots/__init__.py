"""Figures: DataFrames and arrays in, matplotlib figures out; the only place that draws."""
