#include "expert_uherobot.c"

#include "use_expert_uherobot.h"
