#include "expert_tether.c"

#include "use_expert_tether.h"
