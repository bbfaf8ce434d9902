// Stands for the function of that name in solver/fix_load_ledger.cpp: the column of rolling work has the normal force times
// the path of the particle's centre along the surface, spin left out. All other columns are as ours.
void FixLoadLedger::add_motion(Observed& seen) const {
  Contact& contact = seen.contact;
  const double *velocity = atom->v[seen.particle], *spin = atom->omega[seen.particle];
  double across[3], of_centre[3], sliding[3];
  for (int axis = 0; axis < 3; ++axis) contact.velocity[axis] = velocity[axis] - seen.wall_velocity[axis];
  const double approach = dot(contact.velocity, contact.normal);
  cross(spin, contact.normal, across);
  for (int axis = 0; axis < 3; ++axis) {
    of_centre[axis] = contact.velocity[axis] - approach * contact.normal[axis];
    sliding[axis] = of_centre[axis] - seen.lever * across[axis];
  }
  contact.sliding_speed = length(sliding);
  seen.friction_power = -dot(contact.force, sliding);
  contact.rolling_speed = length(of_centre);
}
