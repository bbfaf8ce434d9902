// Which search finds the contacts of particles with meshes: ours, which leaves out pairs that cannot touch yet, or that
// of the solver's library. Both find the same contacts, in the same order.
#pragma once

namespace LAMMPS_NS {
class LAMMPS;
}  // namespace LAMMPS_NS

namespace wall_search {

constexpr char OURS[] = "ours", STOCK[] = "stock";

// Before the deck is read.
void use_stock();

// Leaves the search to a library that ours was not built for, or that does not call ours, and says so.
void prove(LAMMPS_NS::LAMMPS* lammps);

}  // namespace wall_search
