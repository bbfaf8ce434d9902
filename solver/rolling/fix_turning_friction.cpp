#include "fix_turning_friction.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "comm.h"
#include "fix_spin_friction.h"
#include "modify.h"
#include "update.h"

namespace rolling {

namespace {
char ID[] = "turning_friction", GROUP[] = "all", STYLE_NAME[] = "rolling/rvd";
constexpr int SENT = 4;  // numbers of a Turning
// Sweeps end when torques change by less than this share of the largest ones, both in the mean square, or at a number of
// sweeps. A bed at rest needs one, one that flows about a dozen. The first step of a run has none before it.
constexpr double CHANGE = 1e-3, FIRST_CHANGE = 1e-6;
constexpr int SWEEPS = 100, FIRST_SWEEPS = 1000;
constexpr int NONE = -1;
constexpr int NO_TAG = 0;  // of a wall; particles count from 1

double squared(double number) { return number * number; }

// Returns the share of a torque that a contact resists.
double resisted_share(const double* torque, double largest) {
  const double size = std::sqrt(squared(torque[0]) + squared(torque[1]) + squared(torque[2]));
  return size > largest ? largest / size : 1.0;
}
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
  Contact contact{i, j, one, other, {}, largest, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, NONE};
  if (j != WALL && other < one) std::swap(contact.low, contact.high);
  for (int k = 0; k < 3; ++k) contact.normal[k] = normal[k] / length;
  contacts_.push_back(contact);
}

void FixTurningFriction::act() {
  if (!is_due_) return;
  is_due_ = false;
  prepare();
  const std::vector<double> free = spins_;
  start();
  const double enough = squared(is_first_ ? FIRST_CHANGE : CHANGE) * largest_squared();
  double lead = 0.0, pace = 1.0;
  for (int number = is_first_ ? FIRST_SWEEPS : SWEEPS; number > 0; --number) {
    const Swept swept = sweep(lead);
    if (swept.changes <= enough) break;
    const double next = 0.5 + std::sqrt(0.25 + pace * pace);
    lead = swept.overshoots ? 0.0 : (pace - 1.0) / next;
    pace = swept.overshoots ? 1.0 : next;
  }
  const double share = least_energy_share(free);
  for (int particle = 0; particle < atom->nlocal; ++particle) {
    const double inertia_over_step = moment_of_inertia(atom, particle) / update->dt;
    for (int k = 0; k < 3; ++k)
      atom->torque[particle][k] += inertia_over_step * share * (spins_[3 * particle + k] - free[3 * particle + k]);
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
  spins_.resize(3 * atom->nlocal);
  for (int particle = 0; particle < atom->nlocal; ++particle) {
    const double step_over_inertia = update->dt / moment_of_inertia(atom, particle);
    for (int k = 0; k < 3; ++k)
      spins_[3 * particle + k] = atom->omega[particle][k] + step_over_inertia * atom->torque[particle][k];
    turning_[particle].mobility = step_over_inertia * contacts_of_[particle];
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

// Starts from the torques of the step before, within what contacts resist now. Where particles may have changed their
// rank, contacts between ranks start from none, on both.
void FixTurningFriction::start() {
  std::vector<double> torques(3 * atom->nlocal, 0.0);
  for (Contact& contact : contacts_) {
    const Contact* earlier = have_moved_ && is_between(contact) ? nullptr : before(contact);
    if (!earlier) continue;
    double along = 0.0, wanted[3];
    for (int k = 0; k < 3; ++k) along += earlier->torque[k] * contact.normal[k];
    for (int k = 0; k < 3; ++k) wanted[k] = earlier->torque[k] - along * contact.normal[k];
    const double share = resisted_share(wanted, contact.largest);
    for (int k = 0; k < 3; ++k) contact.torque[k] = share * wanted[k];
    add_to(torques, contact, contact.torque);
  }
  spin_up(torques);
}

// Adds a contact's torque to those of its particles on this rank.
void FixTurningFriction::add_to(std::vector<double>& torques, const Contact& contact, const double* torque) const {
  for (int k = 0; k < 3; ++k) {
    torques[3 * contact.i + k] += torque[k];
    if (is_here(contact.j)) torques[3 * contact.j + k] += torque[k];
  }
}

// Changes the spins of this rank's particles by torques (N m, three each).
void FixTurningFriction::spin_up(const std::vector<double>& torques) {
  changes_.resize(torques.size());
  for (int particle = 0; particle < atom->nlocal; ++particle) {
    const double step_over_inertia = update->dt / moment_of_inertia(atom, particle);
    for (int k = 3 * particle; k < 3 * particle + 3; ++k) {
      changes_[k] = step_over_inertia * torques[k];
      spins_[k] += changes_[k];
    }
  }
}

// All contacts see the same spins, then these change. lead: how far torques and spins first go on, of their last change.
FixTurningFriction::Swept FixTurningFriction::sweep(double lead) {
  for (int particle = 0; particle < atom->nlocal; ++particle)
    for (int k = 0; k < 3; ++k)
      turning_[particle].spin[k] = spins_[3 * particle + k] + lead * changes_[3 * particle + k];
  comm->forward_comm_fix(this);
  std::vector<double> torques(3 * atom->nlocal, 0.0);
  double here[2] = {0.0, 0.0}, all[2];  // squares of changes, and what they do against the step since the last torques
  for (Contact& contact : contacts_) {
    const Turning& one = turning_[contact.i];
    const Turning other = contact.j == WALL ? Turning{{0.0, 0.0, 0.0}, 0.0} : turning_[contact.j];
    const double mobility = one.mobility + other.mobility;
    double sum[3], along = 0.0, from[3], wanted[3];
    for (int k = 0; k < 3; ++k) {
      sum[k] = one.spin[k] + other.spin[k];
      along += sum[k] * contact.normal[k];
    }
    for (int k = 0; k < 3; ++k) {
      from[k] = contact.torque[k] + lead * contact.change[k];
      wanted[k] = from[k] - (sum[k] - along * contact.normal[k]) / mobility;
    }
    const double share = resisted_share(wanted, contact.largest), counts = share_of(contact);
    for (int k = 0; k < 3; ++k) {
      const double found = share * wanted[k];
      contact.change[k] = found - contact.torque[k];
      contact.torque[k] = found;
      here[0] += counts * squared(found - from[k]);
      here[1] += counts * mobility * (from[k] - found) * contact.change[k];
    }
    add_to(torques, contact, contact.change);
  }
  spin_up(torques);
  MPI_Allreduce(here, all, 2, MPI_DOUBLE, MPI_SUM, world);
  return {all[0], all[1] > 0.0};
}

// Returns the share of the friction found with which the rotational energy after the step is least: 1 where it is, less
// where sweeps ended early, so that it is never more than without friction. free: spins without it.
double FixTurningFriction::least_energy_share(const std::vector<double>& free) const {
  double here[2] = {0.0, 0.0}, all[2];  // slope of the energy along the share, and its curvature
  for (int particle = 0; particle < atom->nlocal; ++particle) {
    const double inertia = moment_of_inertia(atom, particle);
    for (int k = 3 * particle; k < 3 * particle + 3; ++k) {
      here[0] += inertia * free[k] * (spins_[k] - free[k]);
      here[1] += inertia * squared(spins_[k] - free[k]);
    }
  }
  MPI_Allreduce(here, all, 2, MPI_DOUBLE, MPI_SUM, world);
  return all[0] < 0.0 ? std::min(1.0, -all[0] / all[1]) : 0.0;
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
