"""Equipment of one's own: parts from CAD, a feed in t/h or a filling, and the hours that its liners last."""
