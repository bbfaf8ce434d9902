#include "fix_turning_friction.h"

#include <algorithm>
#include <cmath>

#include "comm.h"
#include "fix_spin_friction.h"
#include "modify.h"
#include "update.h"

namespace rolling {

namespace {
char ID[] = "turning_friction", GROUP[] = "all", STYLE_NAME[] = "rolling/rvd";
constexpr int SWEEPS = 4;
constexpr int SENT = 4;  // numbers of a Turning
}  // namespace

FixTurningFriction::FixTurningFriction(LAMMPS_NS::LAMMPS* lmp, int narg, char** arg) : Fix(lmp, narg, arg) {
  comm_forward = SENT;
}

FixTurningFriction* FixTurningFriction::of(LAMMPS_NS::LAMMPS* lmp) {
  if (lmp->modify->find_fix(ID) < 0) {
    char* words[] = {ID, GROUP, STYLE_NAME};
    lmp->modify->add_fix(3, words);
  }
  return static_cast<FixTurningFriction*>(lmp->modify->find_fix_id(ID));
}

int FixTurningFriction::setmask() {
  using namespace LAMMPS_NS::FixConst;
  return PRE_FORCE | PRE_INITIAL_INTEGRATE | PRE_FINAL_INTEGRATE;
}

void FixTurningFriction::clear() {
  contacts_.clear();
  is_due_ = true;
}

void FixTurningFriction::add(int i, int j, const double* normal, double largest) {
  if (!is_due_ || largest <= 0.0) return;
  const double length = std::hypot(normal[0], normal[1], normal[2]);  // at walls not quite 1
  contacts_.push_back({i, j, {normal[0] / length, normal[1] / length, normal[2] / length}, largest, {0.0, 0.0, 0.0}});
}

void FixTurningFriction::act() {
  if (!is_due_) return;
  is_due_ = false;
  prepare();
  const std::vector<Turning> before(turning_.begin(), turning_.begin() + atom->nlocal);
  for (int number = 0; number < SWEEPS; ++number) sweep();
  for (int particle = 0; particle < atom->nlocal; ++particle) {
    const double inertia_over_step = moment_of_inertia(atom, particle) / update->dt;
    for (int k = 0; k < 3; ++k)
      atom->torque[particle][k] += inertia_over_step * (turning_[particle].spin[k] - before[particle].spin[k]);
  }
}

// Spins as they would be after the step without rolling friction, and how much a contact's torque changes them.
void FixTurningFriction::prepare() {
  contacts_of_.assign(atom->nlocal, 0.0);
  for (const Contact& contact : contacts_) {
    contacts_of_[contact.i] += 1.0;
    if (contact.j != WALL && contact.j < atom->nlocal) contacts_of_[contact.j] += 1.0;
  }
  turning_.resize(atom->nlocal + atom->nghost);
  for (int particle = 0; particle < atom->nlocal; ++particle) {
    const double step_over_inertia = update->dt / moment_of_inertia(atom, particle);
    Turning& turning = turning_[particle];
    for (int k = 0; k < 3; ++k)
      turning.spin[k] = atom->omega[particle][k] + step_over_inertia * atom->torque[particle][k];
    turning.mobility = step_over_inertia * contacts_of_[particle];
  }
}

// All contacts see the same spins, then these change.
void FixTurningFriction::sweep() {
  comm->forward_comm_fix(this);
  std::vector<double> torques(3 * atom->nlocal, 0.0);
  for (Contact& contact : contacts_) {
    const Turning& one = turning_[contact.i];
    const Turning other = contact.j == WALL ? Turning{{0.0, 0.0, 0.0}, 0.0} : turning_[contact.j];
    double sum[3], along = 0.0, wanted[3], squared = 0.0;
    for (int k = 0; k < 3; ++k) {
      sum[k] = one.spin[k] + other.spin[k];
      along += sum[k] * contact.normal[k];
    }
    for (int k = 0; k < 3; ++k) {
      wanted[k] = contact.torque[k] - (sum[k] - along * contact.normal[k]) / (one.mobility + other.mobility);
      squared += wanted[k] * wanted[k];
    }
    const double size = std::sqrt(squared), share = size > contact.largest ? contact.largest / size : 1.0;
    for (int k = 0; k < 3; ++k) {
      const double change = share * wanted[k] - contact.torque[k];
      contact.torque[k] += change;
      torques[3 * contact.i + k] += change;
      if (contact.j != WALL && contact.j < atom->nlocal) torques[3 * contact.j + k] += change;
    }
  }
  for (int particle = 0; particle < atom->nlocal; ++particle) {
    const double step_over_inertia = update->dt / moment_of_inertia(atom, particle);
    for (int k = 0; k < 3; ++k) turning_[particle].spin[k] += step_over_inertia * torques[3 * particle + k];
  }
}

int FixTurningFriction::pack_comm(int count, int* particles, double* buffer, int, int*) {
  double* next = buffer;
  for (int k = 0; k < count; ++k) {
    const Turning& turning = turning_[particles[k]];
    next = std::copy(turning.spin, turning.spin + 3, next);
    *next++ = turning.mobility;
  }
  return SENT;
}

void FixTurningFriction::unpack_comm(int count, int first, double* buffer) {
  for (int k = 0; k < count; ++k, buffer += SENT) {
    std::copy(buffer, buffer + 3, turning_[first + k].spin);
    turning_[first + k].mobility = buffer[3];
  }
}

}  // namespace rolling
