"""Wear from arrays: load ledger, wear laws and displacement of the surface. Reads no files."""

WEAR_VERSION = 6
"""Version of what turns the loads of a cycle into its worn surface, which a cycle's digest holds.

Raise it with every change that changes the volumes or the surface of a cycle by more than rounding: of this package
(ledger, kernels, laws, patch, displacement, caps, remeshing) and of the sums and kernels of `solver/`. Cycles that an
older version has worn are then simulated again. A new law, or an option that is off by default, changes none.
"""
