// Adds the contact models that use our rolling models to the solver's factories. The solver's headers hold the models of
// normal, tangential and cohesive forces as templates; the lists in this folder (style_*_model.h) name those that ours
// are combined with. This file is compiled with hidden symbols, so that the library keeps its own instances.

#include "rolling_models.h"

#include "fix_insert_stream.h"
#include "fix_wall_gran_base.h"
#include "granular_pair_style.h"
#include "granular_wall.h"

// The header of a fix that the public edition of the solver lacks stands in for it, but not for all that pair_gran_base.h
// asks of it. No deck can have that fix.
namespace LAMMPS_NS {
class StreamOfPublicEdition : public FixInsertStream {
 public:
  bool has_inserted() const { return false; }
};
}  // namespace LAMMPS_NS
#define FixInsertStream StreamOfPublicEdition
#include "pair_gran_base.h"
#undef FixInsertStream

namespace rolling {

namespace {

using namespace LIGGGHTS;
using namespace LIGGGHTS::ContactModels;

template <typename Type, typename Interface, typename Parent>
Interface* create(LAMMPS_NS::LAMMPS* lmp, Parent* parent, const int64_t hash) {
  return new Type(lmp, parent, hash);
}

template <int NORMAL, int COHESION, int ROLLING>
void add_model() {
  using Style = GranStyle<NORMAL, TANGENTIAL_HISTORY, COHESION, ROLLING, SURFACE_DEFAULT>;
  using Pair = PairStyles::Granular<ContactModel<Style>>;
  using Wall = Walls::Granular<ContactModel<Style>>;
  PairStyles::Factory::instance().addStyle(
      "gran", Style::HASHCODE, &create<Pair, PairStyles::IGranularPairStyle, LAMMPS_NS::PairGran>);
  Walls::Factory::instance().addStyle(
      "gran", Style::HASHCODE, &create<Wall, Walls::IGranularWall, LAMMPS_NS::FixWallGran>);
}

template <int NORMAL, int ROLLING>
void add_cohesions() {
  add_model<NORMAL, COHESION_OFF, ROLLING>();
  add_model<NORMAL, COHESION_SJKR, ROLLING>();
  add_model<NORMAL, COHESION_SJKR2, ROLLING>();
  add_model<NORMAL, COHESION_WASHINO_CAPILLARY_VISCOUS, ROLLING>();
}

template <int ROLLING>
void add_rolling_model(const char* name) {
  Factory::instance().addRollingModel(name, ROLLING);
  add_cohesions<HERTZ, ROLLING>();
  add_cohesions<HOOKE, ROLLING>();
}

}  // namespace

void add_rolling_models() {
  add_rolling_model<ROLLING_OWN_SPIN>(MODELS[0]);
  add_rolling_model<ROLLING_RVD>(MODELS[1]);
}

}  // namespace rolling
