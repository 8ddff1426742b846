/*
 * An ATmega328P at 16 MHz in simavr, on a line of 115200 baud.
 *
 *     line PROGRAM          bytes of the standard input come without a pause; what the board sends
 *                           goes to the standard output; ends soon after the last byte
 *     line PROGRAM pty      the line is a pseudo-terminal, whose name is printed; ends with the
 *                           standard input
 *
 * A UART has room for two bytes. simavr's has more; so an interrupt that comes too late for a real
 * one ends the program, with 3.
 */
#define _GNU_SOURCE

#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>
#include <simavr/sim_interrupts.h>

#include <fcntl.h>
#include <poll.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <unistd.h>

enum {
    FREQUENCY = 16000000,
    BYTE_CYCLES = 1500,              /* simavr's UART takes eleven bits for a byte, of 136 each */
    START = FREQUENCY / 200,         /* 5 ms, in which the board starts */
    REST = FREQUENCY / 20,           /* 50 ms, in which it answers what came last */
    USART_RX = 18,                   /* vector of the interrupt */
};

static int input = STDIN_FILENO;
static int output = STDOUT_FILENO;
static bool is_terminal;
static bool is_over;
static avr_cycle_count_t ends_at;
static avr_cycle_count_t waits_since;

static avr_cycle_count_t on_byte_time(struct avr_t *avr, avr_cycle_count_t when, void *uart) {
    uint8_t byte;
    const ssize_t count = is_over ? 0 : read(input, &byte, 1);
    if (count == 1) {
        avr_raise_irq((avr_irq_t *)uart, byte);
        ends_at = avr->cycle + REST;
    } else if (!is_terminal) {
        is_over = true;
    }
    return when + BYTE_CYCLES;
}

static void on_sent(struct avr_irq_t *irq, uint32_t value, void *user) {
    const uint8_t byte = (uint8_t)value;
    (void)irq, (void)user;
    if (write(output, &byte, 1) != 1) {
        exit(EXIT_FAILURE);
    }
}

static void on_pending(struct avr_irq_t *irq, uint32_t value, void *user) {
    const avr_t *const avr = user;
    (void)irq;
    if (value) {
        waits_since = avr->cycle;
    } else if (avr->cycle - waits_since >= 2 * BYTE_CYCLES) {
        fprintf(stderr, "an interrupt waited for %lu cycles\n",
                (unsigned long)(avr->cycle - waits_since));
        exit(3);
    }
}

/* Nobody waits for the standard streams: a sleep takes no time. */
static void sleep_at_once(struct avr_t *avr, avr_cycle_count_t cycles) {
    (void)avr, (void)cycles;
}

static void say_nothing(struct avr_t *avr, const int level, const char *format, va_list arguments) {
    (void)avr, (void)level, (void)format, (void)arguments;
}

static int open_terminal(void) {
    struct termios settings;
    const int master = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    if (master < 0 || grantpt(master) != 0 || unlockpt(master) != 0) {
        exit(EXIT_FAILURE);
    }
    /* As long as it is open here, too, whoever else opens it may close it. */
    const int slave = open(ptsname(master), O_RDWR | O_NOCTTY);
    if (slave < 0 || tcgetattr(slave, &settings) != 0) {
        exit(EXIT_FAILURE);
    }
    cfmakeraw(&settings);
    tcsetattr(slave, TCSANOW, &settings);
    puts(ptsname(master));
    fflush(stdout);
    return master;
}

static bool has_ended(void) {
    struct pollfd standard = {.fd = STDIN_FILENO, .events = POLLIN};
    return poll(&standard, 1, 0) == 1;
}

int main(int argc, char **argv) {
    static elf_firmware_t firmware;
    avr_global_logger_set(say_nothing);
    if (argc < 2 || elf_read_firmware(argv[1], &firmware) != 0) {
        return 2;
    }
    avr_t *const avr = avr_make_mcu_by_name("atmega328p");
    if (avr == NULL) {
        return 2;
    }
    avr_init(avr);
    avr->frequency = FREQUENCY;
    avr_load_firmware(avr, &firmware);
    is_terminal = argc > 2 && strcmp(argv[2], "pty") == 0;
    if (is_terminal) {
        input = output = open_terminal();
    } else {
        avr->sleep = sleep_at_once;
    }
    uint32_t flags = 0; /* Neither prints nor sleeps. */
    avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
    avr_irq_t *const uart = avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT),
                            on_sent, NULL);
    avr_irq_register_notify(avr_get_interrupt_irq(avr, USART_RX) + AVR_INT_IRQ_PENDING,
                            on_pending, avr);
    avr_cycle_timer_register(avr, START, on_byte_time, uart);
    int state = cpu_Running;
    for (uint32_t step = 0; state != cpu_Done && state != cpu_Crashed; step++) {
        state = avr_run(avr);
        if (is_terminal ? step % 4096 == 0 && has_ended() : is_over && avr->cycle > ends_at) {
            return EXIT_SUCCESS;
        }
    }
    return EXIT_FAILURE;
}
