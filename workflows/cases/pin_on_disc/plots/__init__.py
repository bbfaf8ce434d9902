"""Drawing functions of the figures of a pin on a disc; tables in, figures out."""
