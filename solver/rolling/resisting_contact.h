// What the rolling models of this folder share: their coefficient, the force that it multiplies, and what they refuse.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "atom.h"
#include "contact_models.h"
#include "error.h"
#include "global_properties.h"
#include "modify.h"
#include "property_registry.h"
#include "rolling_model_base.h"
#include "settings.h"
#include "update.h"

namespace rolling {

class ResistingContact : public LIGGGHTS::ContactModels::RollingModelBase {
 public:
  ResistingContact(LAMMPS_NS::LAMMPS* lmp, LIGGGHTS::IContactHistorySetup* setup,
                   LIGGGHTS::ContactModels::ContactModelBase* model, const char* name)
      : RollingModelBase(lmp, setup, model), name_(name) {}

  void registerSettings(Settings&) override {}
  void postSettings(LIGGGHTS::IContactHistorySetup*, LIGGGHTS::ContactModels::ContactModelBase*) override {}
  void surfacesClose(LIGGGHTS::ContactModels::SurfacesCloseData&, LIGGGHTS::ContactModels::ForceData&,
                     LIGGGHTS::ContactModels::ForceData&) override {}
  void beginPass(LIGGGHTS::ContactModels::SurfacesIntersectData&, LIGGGHTS::ContactModels::ForceData&,
                 LIGGGHTS::ContactModels::ForceData&) override {}
  void endPass(LIGGGHTS::ContactModels::SurfacesIntersectData&, LIGGGHTS::ContactModels::ForceData&,
               LIGGGHTS::ContactModels::ForceData&) override {}

  void connectToProperties(PropertyRegistry& registry) override {
    registry.registerProperty("coeffRollFrict", &MODEL_PARAMS::createCoeffRollFrict);
    registry.connect("coeffRollFrict", coefficient_, ("rolling_friction " + name_).c_str());
    if (modify->n_fixes_style("multisphere") > 0)
      error->all(FLERR, ("rolling_friction " + name_ + ": found multispheres, allowed are spheres.").c_str());
  }

 protected:
  // Coefficient times elastic normal force, N; damping and cohesion take no part, as in the solver's own rolling models.
  double resisted_force(const LIGGGHTS::ContactModels::SurfacesIntersectData& contact) const {
    return coefficient_[contact.itype][contact.jtype] * std::max(0.0, contact.kn * contact.deltan);
  }

  // A contact that was put together by the solver's library must look as it does to us.
  void check(const LIGGGHTS::ContactModels::SurfacesIntersectData& contact) {
    if (checked_) return;
    const double* normal = contact.en;
    const double length = std::hypot(normal[0], normal[1], normal[2]);
    if (contact.radi != atom->radius[contact.i] || contact.itype != atom->type[contact.i] ||
        std::abs(length - 1.0) > UNIT_TOLERANCE)
      error->one(FLERR, ("rolling_friction " + name_ +
                         " does not fit this LIGGGHTS (data of a contact); build it against the headers of the solver "
                         "in use (make -C solver).")
                            .c_str());
    checked_ = true;
  }

 private:
  static constexpr double UNIT_TOLERANCE = 1e-3;  // the solver divides the normal at a wall by radius less overlap

  std::string name_;
  double** coefficient_ = nullptr;
  bool checked_ = false;
};

}  // namespace rolling
