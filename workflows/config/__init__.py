"""What is asked for: layers of settings, units, schemas, checks, studies and their runs."""
