"""Wear from arrays: load ledger, wear laws and displacement of the surface. Reads no files."""
