// Stands for the function of that name in solver/rolling/fix_turning_friction.cpp: every contact acts in full against the
// turning that its particles have before the step, whether or not that ends within the step.
void FixTurningFriction::act() {
  if (!is_due_) return;
  is_due_ = false;
  turning_.resize(atom->nlocal + atom->nghost);
  for (int particle = 0; particle < atom->nlocal; ++particle) {
    turning_[particle].mobility = 0.0;
    for (int k = 0; k < 3; ++k) turning_[particle].spin[k] = atom->omega[particle][k];
  }
  comm->forward_comm_fix(this);
  std::vector<double> torques(3 * atom->nlocal, 0.0);
  for (Contact& contact : contacts_) {
    const Turning& one = turning_[contact.i];
    const Turning other = contact.j == WALL ? Turning{{0.0, 0.0, 0.0}, 0.0} : turning_[contact.j];
    double sum[3], along = 0.0, size = 0.0;
    for (int k = 0; k < 3; ++k) {
      sum[k] = one.spin[k] + other.spin[k];
      along += sum[k] * contact.normal[k];
    }
    for (int k = 0; k < 3; ++k) {
      contact.torque[k] = -(sum[k] - along * contact.normal[k]);
      size += squared(contact.torque[k]);
    }
    size = std::sqrt(size);
    for (int k = 0; k < 3; ++k) contact.torque[k] *= size > 0.0 ? contact.largest / size : 0.0;
    add_to(torques, contact, contact.torque);
  }
  for (int particle = 0; particle < atom->nlocal; ++particle) {
    const double step_over_inertia = update->dt / moment_of_inertia(atom, particle);
    for (int k = 0; k < 3; ++k) {
      const double before = turning_[particle].spin[k], after = before + step_over_inertia * torques[3 * particle + k];
      atom->torque[particle][k] += moment_of_inertia(atom, particle) / update->dt * (after - before);
    }
  }
}
