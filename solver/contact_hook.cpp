// Takes the place of FixMeshSurface::add_particle_contribution: the solver's shared library calls it through its symbol
// table, where a definition in the program comes before the library's own.

#include "contact_hook.h"

#include <dlfcn.h>

#include <algorithm>
#include <vector>

#include "fix_load_ledger.h"

namespace {

// Mangled name of FixMeshSurface::add_particle_contribution(int, double *, double *, int, double *).
constexpr char SYMBOL[] = "_ZN9LAMMPS_NS14FixMeshSurface25add_particle_contributionEiPdS1_iS1_";

using Contribution = void (*)(LAMMPS_NS::FixMeshSurface*, int, double*, double*, int, double*);

struct Listener {
  LAMMPS_NS::FixMeshSurface* mesh;
  load_ledger::FixLoadLedger* ledger;
};

std::vector<Listener> listeners;

Contribution original() {
  static const auto found = reinterpret_cast<Contribution>(dlsym(RTLD_NEXT, SYMBOL));
  return found;
}

}  // namespace

namespace LAMMPS_NS {

// The ledgers look first: the solver's own stress and wear turn the sign of the force.
void FixMeshSurface::add_particle_contribution(int particle, double* force, double* offset, int triangle,
                                               double* wall_velocity) {
  for (const Listener& listener : listeners)
    if (listener.mesh == this) listener.ledger->observe(particle, force, offset, triangle, wall_velocity);
  original()(this, particle, force, offset, triangle, wall_velocity);
}

}  // namespace LAMMPS_NS

namespace load_ledger {

void listen(LAMMPS_NS::FixMeshSurface* mesh, FixLoadLedger* ledger) {
  forget(ledger);
  listeners.push_back({mesh, ledger});
}

void forget(FixLoadLedger* ledger) {
  const auto of_ledger = [ledger](const Listener& listener) { return listener.ledger == ledger; };
  listeners.erase(std::remove_if(listeners.begin(), listeners.end(), of_ledger), listeners.end());
}

const char* hook_fault() {
  if (!original())
    return "the solver's library has no FixMeshSurface::add_particle_contribution to pass contacts on to";
  if (dlsym(RTLD_DEFAULT, SYMBOL) == reinterpret_cast<void*>(original()))
    return "the solver's library uses its own FixMeshSurface::add_particle_contribution";
  return "";
}

}  // namespace load_ledger
