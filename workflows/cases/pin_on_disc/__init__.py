"""A pin that slides round on a disc and wears a groove into it (Yan 2022, chapter 5 and section 4.3.2)."""
