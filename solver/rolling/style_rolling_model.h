#include "rolling_model_own_spin.h"
#include "rolling_model_rvd.h"
