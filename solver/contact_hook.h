// The one place where the solver calls us: once per contact between a particle and a mesh triangle.
#pragma once

#include "fix_mesh_surface.h"

namespace load_ledger {

class FixLoadLedger;

// A ledger is told of the contacts of its mesh while it is registered.
void listen(LAMMPS_NS::FixMeshSurface* mesh, FixLoadLedger* ledger);
void forget(FixLoadLedger* ledger);

// Calls so far on this rank, of all meshes; not one while the solver sees contacts means that it does not call us.
long hook_calls();

// Why the solver cannot be calling us, as a phrase; empty when all is well.
const char* hook_fault();

}  // namespace load_ledger
