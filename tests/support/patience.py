"""How long tests wait for what takes seconds on an idle machine: an end for what hangs, no measure of speed."""

LONGEST_S = 1800.0  # s
