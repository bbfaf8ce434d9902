// Rolling resistance to the velocity with which two surfaces turn over their contact (relative velocity dependent). The
// torque on both particles is mu_r F_n R* against the tangential part of the sum of their spins, R* = R_i R_j/(R_i +
// R_j); at a wall it is that of the particle's spin, with its radius. A single contact never turns that velocity over
// in one step.
#ifdef ROLLING_MODEL
ROLLING_MODEL(ROLLING_RVD, rvd, 41)
#else
#ifndef ROLLING_MODEL_RVD_H
#define ROLLING_MODEL_RVD_H

#include <algorithm>
#include <cmath>

#include "contact_models.h"
#include "fix_spin_friction.h"
#include "resisting_contact.h"

namespace LIGGGHTS {
namespace ContactModels {

template <>
class RollingModel<ROLLING_RVD> : public rolling::ResistingContact {
 public:
  RollingModel(LAMMPS* lmp, IContactHistorySetup* setup, ContactModelBase* model)
      : ResistingContact(lmp, setup, model, "rvd") {}

  void surfacesIntersect(SurfacesIntersectData& contact, ForceData& on_i, ForceData& on_j) override {
    check(contact);
    const double* spin_i = atom->omega[contact.i];
    const double* spin_j = contact.is_wall ? NO_SPIN : atom->omega[contact.j];
    double turning[3], along = 0.0, squared = 0.0;
    for (int k = 0; k < 3; ++k) along += (spin_i[k] + spin_j[k]) * contact.en[k];
    for (int k = 0; k < 3; ++k) {
      turning[k] = spin_i[k] + spin_j[k] - along * contact.en[k];
      squared += turning[k] * turning[k];
    }
    if (squared <= 0.0) return;
    const double speed = std::sqrt(squared);
    const double radius =
        contact.is_wall ? contact.radi : contact.radi * contact.radj / (contact.radi + contact.radj);
    double mobility = 1.0 / rolling::moment_of_inertia(atom, contact.i);
    if (!contact.is_wall) mobility += 1.0 / rolling::moment_of_inertia(atom, contact.j);
    const double stopping = speed / (mobility * update->dt);
    const double torque = std::min(resisted_force(contact) * radius, stopping) / speed;
    for (int k = 0; k < 3; ++k) {
      on_i.delta_torque[k] -= torque * turning[k];
      on_j.delta_torque[k] -= torque * turning[k];
    }
  }

 private:
  static constexpr double NO_SPIN[3] = {0.0, 0.0, 0.0};
};

}  // namespace ContactModels
}  // namespace LIGGGHTS
#endif
#endif
