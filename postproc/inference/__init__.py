"""Calibration: parameters of a simulation from measured responses, by a surrogate and few simulations."""
