"""A submerged sample in the rotating bed of a circular wear tester."""
