// The one place where the solver calls us: once per contact between a particle and a mesh triangle.
#pragma once

#include "fix_mesh_surface.h"

namespace load_ledger {

class FixLoadLedger;

// A ledger is told of the contacts of its mesh while it is registered.
void listen(LAMMPS_NS::FixMeshSurface* mesh, FixLoadLedger* ledger);
void forget(FixLoadLedger* ledger);

// Why the solver cannot be calling us, as a phrase; empty when all is well.
const char* hook_fault();

}  // namespace load_ledger
