/* What a driver of generated code needs of the machine that it runs on. */
#ifndef DRIVER_H
#define DRIVER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

int driver_get(void); /* The next byte of the requests; -1: there are no more. */
void driver_put(uint8_t byte); /* The next byte of the answers. */
void driver_done(void); /* A request has been answered. */

void driver_run(void); /* Answers all requests. */

#endif
