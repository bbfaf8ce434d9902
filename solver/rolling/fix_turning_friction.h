// Dry friction on the turning of surfaces over their contacts: the tangential part of the sum of two particles' spins, at
// a wall of one. What each contact can resist stops the turning that it would have after the step, or acts against it in
// full. It works on the complete torque, of pairs and of walls.
//
// A particle's contacts stop its spin together: their torques make the rotational energy after the step least. They are
// sought from those of the step before, by sweeps over all contacts. In each a contact takes a share of its particles'
// inertia, one over their number, so that none overshoots: a projected gradient descent, which goes on beyond each step
// by a part of it until that turns back (Beck and Teboulle 2009; O'Donoghue and Candes 2015). Energy is never more than
// without rolling friction. Nothing depends on the order of contacts, and on ranks no more than sweeps leave undone.
#pragma once

#include <vector>

#include "atom.h"
#include "fix.h"

namespace rolling {

constexpr int WALL = -1;  // in place of a second particle

class FixTurningFriction : public LAMMPS_NS::Fix {
 public:
  FixTurningFriction(LAMMPS_NS::LAMMPS* lmp, int narg, char** arg);

  // The one of a simulation, made at the first call.
  static FixTurningFriction* of(LAMMPS_NS::LAMMPS* lmp);

  // Adds a contact of particle i of this rank with j, of any, or a WALL: normal, largest torque (N m).
  void add(int i, int j, const double* normal, double largest);

  int setmask() override;
  void setup_pre_force(int) override;
  void pre_exchange() override;
  void pre_force(int) override { clear(); }
  void pre_initial_integrate() override { act(); }
  void pre_final_integrate() override { act(); }
  int pack_comm(int count, int* particles, double* buffer, int, int*) override;
  void unpack_comm(int count, int first, double* buffer) override;

 private:
  struct Contact {
    int i, j;
    int low, high;  // tags of the two particles, of which a wall has none
    double normal[3], largest, torque[3], change[3];  // -, N m, N m, N m in the last sweep
    int next;  // in the list of the step before: another contact of the same particle
  };
  struct Turning {
    double spin[3], mobility;  // rad/s after the step; rad/s per N m, of one contact's share of the inertia
  };
  struct Swept {
    double changes;   // sum of squares, N2 m2
    bool overshoots;  // the sweep went back
  };

  void clear();
  void act();
  double largest_squared() const;
  void prepare();
  void remember();
  void start();
  Swept sweep(double lead);
  double least_energy_share(const std::vector<double>& free) const;
  void add_to(std::vector<double>& torques, const Contact& contact, const double* torque) const;
  void spin_up(const std::vector<double>& torques);
  bool is_here(int particle) const { return particle != WALL && particle < atom->nlocal; }
  // With a particle of another rank, or the image of one of this: the other side has this contact too.
  bool is_between(const Contact& contact) const { return contact.j != WALL && !is_here(contact.j); }
  double share_of(const Contact& contact) const { return is_between(contact) ? 0.5 : 1.0; }  // in a sum over ranks
  const Contact* before(const Contact& contact) const;

  bool is_due_ = false;     // contacts were evaluated and have not acted
  bool is_first_ = true;    // of a run: no step before
  bool have_moved_ = true;  // particles, between ranks, since the step before
  std::vector<Contact> contacts_, before_;
  std::vector<int> first_of_;        // by tag of a particle: its first contact in the list of the step before, or none
  std::vector<Turning> turning_;     // of each particle, those of other ranks too
  std::vector<double> spins_, changes_;  // of each particle of this rank: rad/s after the step, and in the last sweep
  std::vector<double> contacts_of_;  // of each particle of this rank
};

}  // namespace rolling
