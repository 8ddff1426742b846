/* Matty's status out of whole buffers, by hand with SSE2. */
#ifndef SSE2_MATTY_H
#define SSE2_MATTY_H

#include "expert_matty.h"

/*
 * Takes bytes up to the end of the first message, which it writes to `status`. Returns how many.
 * *complete is false where there is none, and the bytes that are left belong in front of those to
 * come.
 */
size_t sse2_matty_next(const uint8_t *data, size_t size, struct expert_matty_status *status,
                       bool *complete);

#endif
