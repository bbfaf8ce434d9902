// Dry friction on the turning of surfaces over their contacts: the tangential part of the sum of two particles' spins, at
// a wall of one. What each contact can resist stops the turning that it would have after the step, or acts against it in
// full. It works on the complete torque, of pairs and of walls.
//
// A particle's contacts stop its spin together. Each takes a share of its inertia, one over their number, so that none
// overshoots, in a few sweeps over all of them: a projected gradient descent of the rotational energy after the step,
// which is never more than without rolling friction. Nothing depends on the order of contacts, or on ranks.
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
  void setup_pre_force(int) override { clear(); }
  void pre_force(int) override { clear(); }
  void pre_initial_integrate() override { act(); }
  void pre_final_integrate() override { act(); }
  int pack_comm(int count, int* particles, double* buffer, int, int*) override;
  void unpack_comm(int count, int first, double* buffer) override;

 private:
  struct Contact {
    int i, j;
    double normal[3], largest, torque[3];  // -, N m, N m
  };
  struct Turning {
    double spin[3], mobility;  // rad/s after the step; rad/s per N m, of one contact's share of the inertia
  };

  void clear();
  void act();
  void prepare();
  void sweep();

  bool is_due_ = false;  // contacts were evaluated and have not acted
  std::vector<Contact> contacts_;
  std::vector<Turning> turning_;     // of each particle, those of other ranks too
  std::vector<double> contacts_of_;  // of each particle of this rank
};

}  // namespace rolling
