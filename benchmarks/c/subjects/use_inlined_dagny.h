#include "expert_dagny.c"

#include "use_expert_dagny.h"
