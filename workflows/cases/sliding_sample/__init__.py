"""A sample, patterned or plain, that slides through a bed of particles: everything of this case."""
