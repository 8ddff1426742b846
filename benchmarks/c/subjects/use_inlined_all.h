#define RN1 "use_inlined_rn1.h"
#define ATRV "use_inlined_atrv.h"
#define MATTY "use_inlined_matty.h"
#include "use_all.h"
