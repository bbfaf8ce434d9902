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
constexpr int SENT = 4;  // numbers of a Turning
// Sweeps end when torques change by less than this share of the largest ones, both in the mean square, or at a number of
// sweeps. A bed at rest needs one or two, one that flows about ten. The first step of a run has none before it.
constexpr double CHANGE = 1e-3, FIRST_CHANGE = 1e-6;
constexpr int SWEEPS = 100, FIRST_SWEEPS = 1000;
constexpr int NONE = -1;
constexpr int NO_TAG = 0;  // of a wall; particles count from 1

double squared(double number) { return number * number; }
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
  return PRE_EXCHANGE | PRE_FORCE | PRE_INITIAL_INTEGRATE | PRE_FINAL_INTEGRATE;
}

void FixTurningFriction::setup_pre_force(int) {
  is_first_ = true;
  pre_exchange();
  clear();
}

void FixTurningFriction::pre_exchange() { have_moved_ = comm->nprocs > 1; }

void FixTurningFriction::clear() {
  contacts_.clear();
  is_due_ = true;
}

void FixTurningFriction::add(int i, int j, const double* normal, double largest) {
  if (!is_due_ || largest <= 0.0) return;
  const double length = std::hypot(normal[0], normal[1], normal[2]);  // at walls not quite 1
  const int one = atom->tag[i], other = j == WALL ? NO_TAG : atom->tag[j];
  Contact contact{i, j, one, other, {}, largest, {0.0, 0.0, 0.0}, NONE};
  if (j != WALL && other < one) std::swap(contact.low, contact.high);
  for (int k = 0; k < 3; ++k) contact.normal[k] = normal[k] / length;
  contacts_.push_back(contact);
}

void FixTurningFriction::act() {
  if (!is_due_) return;
  is_due_ = false;
  prepare();
  const std::vector<Turning> free(turning_.begin(), turning_.begin() + atom->nlocal);
  start();
  const double enough = squared(is_first_ ? FIRST_CHANGE : CHANGE) * largest_squared();
  for (int number = is_first_ ? FIRST_SWEEPS : SWEEPS; number > 0 && sweep() > enough; --number) {}
  for (int particle = 0; particle < atom->nlocal; ++particle) {
    const double inertia_over_step = moment_of_inertia(atom, particle) / update->dt;
    for (int k = 0; k < 3; ++k)
      atom->torque[particle][k] += inertia_over_step * (turning_[particle].spin[k] - free[particle].spin[k]);
  }
  remember();
}

// Returns the sum of squares of the largest torques, N2 m2, of the contacts of all ranks.
double FixTurningFriction::largest_squared() const {
  double here = 0.0, all;
  for (const Contact& contact : contacts_) here += share_of(contact) * squared(contact.largest);
  MPI_Allreduce(&here, &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return all;
}

// Spins as they would be after the step without rolling friction, and how much a contact's torque changes them.
void FixTurningFriction::prepare() {
  contacts_of_.assign(atom->nlocal, 0.0);
  for (const Contact& contact : contacts_) {
    contacts_of_[contact.i] += 1.0;
    if (is_here(contact.j)) contacts_of_[contact.j] += 1.0;
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

// Keeps the contacts of this step for the next, with the first of each particle.
void FixTurningFriction::remember() {
  for (const Contact& contact : before_) first_of_[contact.low] = NONE;
  before_.swap(contacts_);
  for (int number = 0; number < static_cast<int>(before_.size()); ++number) {
    Contact& contact = before_[number];
    if (contact.low >= static_cast<int>(first_of_.size())) first_of_.resize(contact.low + 1, NONE);
    contact.next = first_of_[contact.low];
    first_of_[contact.low] = number;
  }
  is_first_ = have_moved_ = false;
}

// Returns a contact as it was a step before, of several with walls the one whose normal has turned least, or none.
const FixTurningFriction::Contact* FixTurningFriction::before(const Contact& contact) const {
  const Contact* found = nullptr;
  double closest = -2.0;
  if (contact.low >= static_cast<int>(first_of_.size())) return found;
  for (int number = first_of_[contact.low]; number != NONE; number = before_[number].next) {
    const Contact& candidate = before_[number];
    if (candidate.high != contact.high) continue;
    double along = 0.0;
    for (int k = 0; k < 3; ++k) along += candidate.normal[k] * contact.normal[k];
    if (std::abs(along) > closest) {
      closest = std::abs(along);
      found = &candidate;
    }
  }
  return found;
}

// Starts from the torques of the step before, within what contacts resist now, scaled for the least energy. Where
// particles may have changed their rank, contacts between ranks start from none, on both.
void FixTurningFriction::start() {
  std::vector<double> torques(3 * atom->nlocal, 0.0);
  for (Contact& contact : contacts_) {
    const Contact* earlier = have_moved_ && is_between(contact) ? nullptr : before(contact);
    if (!earlier) continue;
    double along = 0.0, square = 0.0;
    for (int k = 0; k < 3; ++k) along += earlier->torque[k] * contact.normal[k];
    for (int k = 0; k < 3; ++k) {
      contact.torque[k] = earlier->torque[k] - along * contact.normal[k];
      square += squared(contact.torque[k]);
    }
    const double size = std::sqrt(square), share = size > contact.largest ? contact.largest / size : 1.0;
    for (int k = 0; k < 3; ++k) {
      contact.torque[k] *= share;
      torques[3 * contact.i + k] += contact.torque[k];
      if (is_here(contact.j)) torques[3 * contact.j + k] += contact.torque[k];
    }
  }
  // energy along the scale: its slope at none, and twice its curvature
  double here[2] = {0.0, 0.0}, all[2];
  for (int particle = 0; particle < atom->nlocal; ++particle) {
    const double step_over_inertia = update->dt / moment_of_inertia(atom, particle);
    for (int k = 0; k < 3; ++k) {
      const double torque = torques[3 * particle + k];
      here[0] += turning_[particle].spin[k] * torque;
      here[1] += step_over_inertia * squared(torque);
    }
  }
  MPI_Allreduce(here, all, 2, MPI_DOUBLE, MPI_SUM, world);
  const double scale = all[0] < 0.0 ? std::min(1.0, -all[0] / all[1]) : 0.0;
  for (Contact& contact : contacts_)
    for (int k = 0; k < 3; ++k) contact.torque[k] *= scale;
  for (double& torque : torques) torque *= scale;
  spin_up(torques);
}

// Changes the spins of this rank's particles by torques (N m, three each).
void FixTurningFriction::spin_up(const std::vector<double>& torques) {
  for (int particle = 0; particle < atom->nlocal; ++particle) {
    const double step_over_inertia = update->dt / moment_of_inertia(atom, particle);
    for (int k = 0; k < 3; ++k) turning_[particle].spin[k] += step_over_inertia * torques[3 * particle + k];
  }
}

// All contacts see the same spins, then these change. Returns the sum of squares of the changes of torque, N2 m2.
double FixTurningFriction::sweep() {
  comm->forward_comm_fix(this);
  std::vector<double> torques(3 * atom->nlocal, 0.0);
  double changes = 0.0, all;
  for (Contact& contact : contacts_) {
    const Turning& one = turning_[contact.i];
    const Turning other = contact.j == WALL ? Turning{{0.0, 0.0, 0.0}, 0.0} : turning_[contact.j];
    double sum[3], along = 0.0, wanted[3], square = 0.0;
    for (int k = 0; k < 3; ++k) {
      sum[k] = one.spin[k] + other.spin[k];
      along += sum[k] * contact.normal[k];
    }
    for (int k = 0; k < 3; ++k) {
      wanted[k] = contact.torque[k] - (sum[k] - along * contact.normal[k]) / (one.mobility + other.mobility);
      square += squared(wanted[k]);
    }
    const double size = std::sqrt(square), share = size > contact.largest ? contact.largest / size : 1.0;
    for (int k = 0; k < 3; ++k) {
      const double change = share * wanted[k] - contact.torque[k];
      contact.torque[k] += change;
      torques[3 * contact.i + k] += change;
      if (is_here(contact.j)) torques[3 * contact.j + k] += change;
      changes += share_of(contact) * squared(change);
    }
  }
  spin_up(torques);
  MPI_Allreduce(&changes, &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return all;
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
