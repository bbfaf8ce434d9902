"""Closed forms, cited: what results are compared with and what follows from them. Imports nothing else of ours."""
