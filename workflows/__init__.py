"""Workflow side of the toolkit: configuration, decks, the driver of wear cycles and the Snakemake rules."""
