// Dry friction on the spin of each particle: what all its contacts can resist together stops the spin that it would
// have after the step, or acts against it in full. It works on the complete torque, of pairs and of walls, and creates
// no energy; where it holds a particle the spin is exactly none, whatever the time step.
#pragma once

#include <vector>

#include "atom.h"
#include "fix.h"

namespace rolling {

constexpr double SOLID_SPHERE = 0.4;  // moment of inertia over mass and radius squared

inline double moment_of_inertia(const LAMMPS_NS::Atom* atom, int particle) {
  return SOLID_SPHERE * atom->rmass[particle] * atom->radius[particle] * atom->radius[particle];
}

class FixSpinFriction : public LAMMPS_NS::Fix {
 public:
  FixSpinFriction(LAMMPS_NS::LAMMPS* lmp, int narg, char** arg) : Fix(lmp, narg, arg) {}

  // The one of a simulation, made at the first call.
  static FixSpinFriction* of(LAMMPS_NS::LAMMPS* lmp);

  // Adds the largest torque (N m) of a contact of a particle; that of another rank's particle that rank adds.
  void add(int particle, double torque);

  int setmask() override;
  void setup_pre_force(int) override { clear(); }
  void pre_force(int) override { clear(); }
  void pre_initial_integrate() override { act(); }
  void pre_final_integrate() override { act(); }

 private:
  void clear();
  void act();

  std::vector<double> largest_;  // N m, of each particle since the last evaluation of the contacts
};

}  // namespace rolling
