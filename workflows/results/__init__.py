"""The pages of results in docs: remade from their runs, or told to be older than the code."""
