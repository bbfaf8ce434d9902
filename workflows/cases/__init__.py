"""The cases that a study can be about: a folder each, whose module `case` registers it (`workflows.engine.case`)."""
