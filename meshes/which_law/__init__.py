"""Transfer chute of the study `chute`: the script that draws it."""
