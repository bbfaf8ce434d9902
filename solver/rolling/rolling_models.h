// Rolling models of our own beside the solver's: rolling_friction own_spin and rvd, for pairs and walls.
#pragma once

namespace rolling {

constexpr const char* MODELS[] = {"own_spin", "rvd"};

// Makes the solver know them; before the deck is read.
void add_rolling_models();

}  // namespace rolling
