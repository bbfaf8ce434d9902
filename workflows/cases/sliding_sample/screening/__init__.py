"""Screening studies: their runs by flow regime, the regression of their wear, the source's findings beside them."""
