#include "normal_model_hertz.h"
#include "normal_model_hooke.h"
