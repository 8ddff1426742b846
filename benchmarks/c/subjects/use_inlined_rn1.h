#include "expert_rn1.c"

#include "use_expert_rn1.h"
