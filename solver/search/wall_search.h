// Which search finds the contacts of particles with meshes: ours, which leaves out pairs that cannot touch yet, or that
// of the solver's library. Both find the same contacts, in the same order.
#pragma once

namespace wall_search {

constexpr char OURS[] = "ours", STOCK[] = "stock";

// Before the deck is read.
void use_stock();

}  // namespace wall_search
