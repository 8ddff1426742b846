/*
 * counter PROGRAM.elf: runs a program on an ATmega328P and prints `mark MARK CYCLE`, `say BYTE`, and
 * at the end `pc ADDRESS CYCLES` for each instruction between the marks 1 and 2.
 */
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>
#include <simavr/sim_io.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int done;
static int decoding;
static unsigned long long spent[0x8000];

static void mark(struct avr_t *avr, avr_io_addr_t address, uint8_t value, void *user) {
    (void)user;
    avr->data[address] = value;
    printf("mark %d %llu\n", value, (unsigned long long)avr->cycle);
    done = value == 0xFF;
    decoding = value == 1;
}

static void say(struct avr_t *avr, avr_io_addr_t address, uint8_t value, void *user) {
    (void)user;
    avr->data[address] = value;
    printf("say %d\n", value);
}

int main(int count, char **arguments) {
    elf_firmware_t firmware;
    avr_t *const avr = avr_make_mcu_by_name("atmega328p");
    memset(&firmware, 0, sizeof firmware);
    if (count != 2 || avr == NULL || elf_read_firmware(arguments[1], &firmware) != 0) {
        return 2;
    }
    avr_init(avr);
    avr->frequency = 16000000;
    avr_load_firmware(avr, &firmware);
    avr_register_io_write(avr, 0x3E, mark, NULL);
    avr_register_io_write(avr, 0x4A, say, NULL);
    while (!done && avr->cycle < 2000000000ULL) {
        const avr_flashaddr_t at = avr->pc;
        const avr_cycle_count_t before = avr->cycle;
        const int state = avr_run(avr);
        if (decoding) {
            spent[at] += avr->cycle - before;
        }
        if (state == cpu_Crashed || state == cpu_Done) {
            return 1;
        }
    }
    for (unsigned at = 0; at < 0x8000; at++) {
        if (spent[at] != 0) {
            printf("pc %u %llu\n", at, spent[at]);
        }
    }
    return done ? 0 : 1;
}
