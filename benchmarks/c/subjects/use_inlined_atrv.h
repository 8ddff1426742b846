#include "expert_atrv.c"

#include "use_expert_atrv.h"
