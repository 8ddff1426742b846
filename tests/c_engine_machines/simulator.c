/*
 * Runs a program on simavr's ATmega328P. Reading GPIOR0 takes the next byte of the standard input,
 * GPIOR2 says whether there is one, and writing GPIOR1 writes to the standard output.
 */
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

enum { GPIOR0 = 0x3E, GPIOR1 = 0x4A, GPIOR2 = 0x4B };

static uint8_t on_get(struct avr_t *avr, avr_io_addr_t address, void *user) {
    (void)avr, (void)address, (void)user;
    return (uint8_t)getchar();
}

static uint8_t on_more(struct avr_t *avr, avr_io_addr_t address, void *user) {
    (void)avr, (void)address, (void)user;
    const int byte = getchar();
    if (byte != EOF) {
        ungetc(byte, stdin);
    }
    return byte != EOF;
}

static void on_put(struct avr_t *avr, avr_io_addr_t address, uint8_t value, void *user) {
    (void)avr, (void)address, (void)user;
    putchar(value);
}

/* The standard output is the program's. */
static void say_nothing(struct avr_t *avr, const int level, const char *format, va_list arguments) {
    (void)avr, (void)level, (void)format, (void)arguments;
}

int main(int argc, char **argv) {
    elf_firmware_t firmware = {{0}};
    avr_global_logger_set(say_nothing);
    if (argc != 2 || elf_read_firmware(argv[1], &firmware) != 0) {
        return 2;
    }
    avr_t *const avr = avr_make_mcu_by_name("atmega328p");
    if (avr == NULL) {
        return 2;
    }
    avr_init(avr);
    avr->frequency = 16000000;
    avr_load_firmware(avr, &firmware);
    avr_register_io_read(avr, GPIOR0, on_get, NULL);
    avr_register_io_read(avr, GPIOR2, on_more, NULL);
    avr_register_io_write(avr, GPIOR1, on_put, NULL);
    int state = cpu_Running;
    while (state != cpu_Done && state != cpu_Crashed) {
        state = avr_run(avr);
    }
    fflush(stdout);
    return state == cpu_Done ? EXIT_SUCCESS : EXIT_FAILURE;
}
