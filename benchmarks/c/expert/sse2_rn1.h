/* RN#1's gyro and lidar out of whole buffers, by hand with SSE2. */
#ifndef SSE2_RN1_H
#define SSE2_RN1_H

#include "expert_rn1.h"

/*
 * Takes bytes up to the end of the first message, which it writes to `gyro` or `lidar`. Returns how
 * many; *id is the message's identity. 0: there is none, and the bytes that are left belong in
 * front of those to come.
 */
size_t sse2_rn1_next(const uint8_t *data, size_t size, struct expert_rn1_gyro *gyro,
                     struct expert_rn1_lidar *lidar, uint8_t *id);

#endif
