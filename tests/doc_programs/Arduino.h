// Stands in for Arduino's core: the port is two buffers, the pins are silent.
#pragma once
#include <cstddef>
#include <cstdint>
#define HIGH 1
#define LOW 0
#define OUTPUT 1
#define LED_BUILTIN 13
static inline void pinMode(int, int) {}
static inline void digitalWrite(int, int) {}
struct Port {
    const uint8_t *input = nullptr;
    size_t left = 0;
    uint8_t output[64] = {};
    size_t written = 0;
    void begin(long) {}
    size_t available() { return left; }
    int read() { left--; return *input++; }
    void write(uint8_t byte) { output[written++] = byte; }
};
static Port Serial;
