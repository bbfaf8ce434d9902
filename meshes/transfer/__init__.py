"""Transfer chute of the tutorial: the script that draws it."""
