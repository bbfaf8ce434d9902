// Rolling resistance to the velocity with which two surfaces turn over their contact (relative velocity dependent). The
// largest torque on both particles is mu_r F_n R* against the tangential part of the sum of their spins, R* = R_i R_j/(R_i
// + R_j); at a wall it is that of the particle's spin, with its radius. All contacts act as dry friction at once.
#ifdef ROLLING_MODEL
ROLLING_MODEL(ROLLING_RVD, rvd, 41)
#else
#ifndef ROLLING_MODEL_RVD_H
#define ROLLING_MODEL_RVD_H

#include "contact_models.h"
#include "fix_turning_friction.h"
#include "resisting_contact.h"

namespace LIGGGHTS {
namespace ContactModels {

template <>
class RollingModel<ROLLING_RVD> : public rolling::ResistingContact {
 public:
  RollingModel(LAMMPS* lmp, IContactHistorySetup* setup, ContactModelBase* model)
      : ResistingContact(lmp, setup, model, "rvd") {}

  void connectToProperties(PropertyRegistry& registry) override {
    ResistingContact::connectToProperties(registry);
    friction_ = rolling::FixTurningFriction::of(lmp);
  }

  void surfacesIntersect(SurfacesIntersectData& contact, ForceData&, ForceData&) override {
    check(contact);
    if (!contact.computeflag) return;
    const int other = contact.is_wall ? rolling::WALL : contact.j;
    const double radius =
        contact.is_wall ? contact.radi : contact.radi * contact.radj / (contact.radi + contact.radj);
    friction_->add(contact.i, other, contact.en, resisted_force(contact) * radius);
  }

 private:
  rolling::FixTurningFriction* friction_ = nullptr;
};

}  // namespace ContactModels
}  // namespace LIGGGHTS
#endif
#endif
