#include "cohesion_model_sjkr.h"
#include "cohesion_model_sjkr2.h"
#include "cohesion_model_washino_capillary_viscous.h"
