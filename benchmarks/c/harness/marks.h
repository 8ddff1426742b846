/*
 * What a program tells the simulator that it runs in: marks, whose cycles are noted, and bytes.
 * simavr has an ATmega328P and Unicorn a Cortex-M0; MARK(END) stands behind everything.
 */
#ifndef MARKS_H
#define MARKS_H

#if defined(__AVR__)
#include <avr/pgmspace.h>
#define MARK(number) (*(volatile uint8_t *)0x003E = (number)) /* GPIOR0 */
#define SAY (*(volatile uint8_t *)0x004A)                     /* GPIOR1 */
#define END 0xFF
#else
/* Moves of r9 to r12 and of lr to itself. */
#define MARK(number) __asm__ volatile(".short " MARK_##number ::: "memory")
#define MARK_1 "0x46C9"
#define MARK_2 "0x46D2"
#define MARK_3 "0x46DB"
#define MARK_4 "0x46E4"
#define MARK_END "0x46F6"
#define SAY (*(volatile uint8_t *)0x40002000)
#define PROGMEM
#define pgm_read_byte(at) (*(at))
#define pgm_read_word(at) (*(at))
#define memcpy_P memcpy
#endif

#endif
