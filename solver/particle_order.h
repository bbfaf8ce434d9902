// In which order particles lie in memory: ours, near to each other what is near in space, or that of the solver's
// library, by layers of the domain. Forces are then summed in another order: the last digits differ.
#pragma once

namespace particle_order {

// Before the deck is read.
void use_stock();

}  // namespace particle_order
