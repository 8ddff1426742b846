#include "expert_rover.c"

#include "use_expert_rover.h"
