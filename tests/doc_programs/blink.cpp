// Gives the sketch two commands, and looks for two acks.
#include <cstring>

int main() {
    // Noise, then `led` on with counter 7 and off with 8; the sums by hand:
    // 03 + 07 + 01 + 01 = 0C -> F4, 03 + 08 + 01 + 00 = 0C -> F4.
    static const uint8_t line[] = {0xAA, 0x55, 0x03, 0x07, 0x01, 0x01, 0xF4,
                                   0x55, 0x03, 0x08, 0x01, 0x00, 0xF4};
    // 03 + 07 + 02 + 01 = 0D -> F3, 03 + 08 + 02 + 00 = 0D -> F3.
    static const uint8_t acks[] = {0x55, 0x03, 0x07, 0x02, 0x01, 0xF3,
                                   0x55, 0x03, 0x08, 0x02, 0x00, 0xF3};
    setup();
    Serial.input = line;
    Serial.left = sizeof line;
    loop();
    return Serial.written == sizeof acks && !std::memcmp(Serial.output, acks, sizeof acks) ? 0 : 1;
}
