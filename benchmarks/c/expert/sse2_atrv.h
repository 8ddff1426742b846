/* rFLEX's motor and sonar packets out of whole buffers, by hand with SSE2. */
#ifndef SSE2_ATRV_H
#define SSE2_ATRV_H

#include "expert_atrv.h"

/*
 * Takes bytes up to the end of the first message, which it writes to `motor` or `sonar`. Returns
 * how many; *which says which message. 0: there is none, and the bytes that are left belong in
 * front of those to come.
 */
size_t sse2_atrv_next(const uint8_t *data, size_t size, struct expert_atrv_motor *motor,
                      struct expert_atrv_sonar *sonar, uint8_t *which);

#endif
