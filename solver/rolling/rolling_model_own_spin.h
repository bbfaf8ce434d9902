// Rolling resistance on each particle's own spin: the largest torque of a contact is mu_r F_n R_i, R_i the radius of
// the particle (full). All contacts of a particle resist the same spin, so they are summed and act as one dry friction.
#ifdef ROLLING_MODEL
ROLLING_MODEL(ROLLING_OWN_SPIN, own_spin, 40)
#else
#ifndef ROLLING_MODEL_OWN_SPIN_H
#define ROLLING_MODEL_OWN_SPIN_H

#include "contact_models.h"
#include "fix_spin_friction.h"
#include "resisting_contact.h"

namespace LIGGGHTS {
namespace ContactModels {

template <>
class RollingModel<ROLLING_OWN_SPIN> : public rolling::ResistingContact {
 public:
  RollingModel(LAMMPS* lmp, IContactHistorySetup* setup, ContactModelBase* model)
      : ResistingContact(lmp, setup, model, "own_spin") {}

  void connectToProperties(PropertyRegistry& registry) override {
    ResistingContact::connectToProperties(registry);
    friction_ = rolling::FixSpinFriction::of(lmp);
  }

  void surfacesIntersect(SurfacesIntersectData& contact, ForceData&, ForceData&) override {
    check(contact);
    if (!contact.computeflag) return;
    const double force = resisted_force(contact);
    friction_->add(contact.i, force * contact.radi);
    if (!contact.is_wall) friction_->add(contact.j, force * contact.radj);
  }

 private:
  rolling::FixSpinFriction* friction_ = nullptr;
};

}  // namespace ContactModels
}  // namespace LIGGGHTS
#endif
#endif
