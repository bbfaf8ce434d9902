"""Statistics of computer experiments: designs, regressions and their choice, steadiness, lines, verdicts."""
