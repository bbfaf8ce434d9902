// The contact kernels that a deck may ask for: those of kernels.h, and those of a library that a project has compiled of
// its own (workflows/engine/own_kernels.py), which count first.
#pragma once

#include <vector>

#include "kernels.h"

namespace load_ledger {

// All kernels; one of a project stands for one of kernels.h of its name.
const std::vector<Kernel>& kernels();

// Adds the kernels of a shared library, which holds `extern "C" const Kernel OWN_KERNELS[]` with an entry without a name
// at its end. Returns nullptr, or what is wrong.
const char* load_own_kernels(const char* library);

}  // namespace load_ledger
