#include "expert_matty.c"

#include "use_expert_matty.h"
