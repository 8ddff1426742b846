#define RN1 "use_expert_rn1.h"
#define ATRV "use_expert_atrv.h"
#define MATTY "use_expert_matty.h"
#include "use_all.h"
