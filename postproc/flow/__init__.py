"""The flow of particles: snapshots of a bed, bins that travel with a sample, packing, slopes at rest."""
