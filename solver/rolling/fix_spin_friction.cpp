#include "fix_spin_friction.h"

#include <algorithm>
#include <cmath>

#include "modify.h"
#include "update.h"

namespace rolling {

namespace {
char ID[] = "spin_friction", GROUP[] = "all", STYLE_NAME[] = "rolling/own_spin";
}

FixSpinFriction* FixSpinFriction::of(LAMMPS_NS::LAMMPS* lmp) {
  if (lmp->modify->find_fix(ID) < 0) {
    char* words[] = {ID, GROUP, STYLE_NAME};
    lmp->modify->add_fix(3, words);
  }
  return static_cast<FixSpinFriction*>(lmp->modify->find_fix_id(ID));
}

int FixSpinFriction::setmask() {
  using namespace LAMMPS_NS::FixConst;
  return PRE_FORCE | PRE_INITIAL_INTEGRATE | PRE_FINAL_INTEGRATE;
}

void FixSpinFriction::add(int particle, double torque) {
  if (particle < static_cast<int>(largest_.size())) largest_[particle] += torque;
}

void FixSpinFriction::clear() { largest_.assign(atom->nlocal, 0.0); }

void FixSpinFriction::act() {
  const int count = std::min(atom->nlocal, static_cast<int>(largest_.size()));
  for (int particle = 0; particle < count; ++particle) {
    const double largest = largest_[particle];
    if (largest <= 0.0) continue;
    const double inertia_over_step = moment_of_inertia(atom, particle) / update->dt;
    const double* spin = atom->omega[particle];
    double* torque = atom->torque[particle];
    double stopping[3], squared = 0.0;
    for (int k = 0; k < 3; ++k) {
      stopping[k] = -(inertia_over_step * spin[k] + torque[k]);
      squared += stopping[k] * stopping[k];
    }
    const double size = std::sqrt(squared), share = size > largest ? largest / size : 1.0;
    for (int k = 0; k < 3; ++k) torque[k] += share * stopping[k];
  }
  largest_.clear();
}

}  // namespace rolling
