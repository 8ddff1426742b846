#include "expert_probe.c"

#include "use_expert_probe.h"
