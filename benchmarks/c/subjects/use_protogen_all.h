#define RN1 "use_protogen_rn1.h"
#define ATRV "use_protogen_atrv.h"
#define MATTY "use_protogen_matty.h"
#include "use_all.h"
