"""Figures of a calibration: tables in, figures out."""
