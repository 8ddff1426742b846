/* Checksums as the machine computes them best: CCITT by whole bytes, CRC-32 by a table of 16. */
#ifndef EXPERT_CRC_H
#define EXPERT_CRC_H

#include <stdint.h>

#if defined(__AVR__)
#include <avr/pgmspace.h>
#include <util/crc16.h>
#define expert_ccitt _crc_ccitt_update
#define EXPERT_FLASH PROGMEM
#else
#define EXPERT_FLASH

/* x^16 + x^12 + x^5 + 1, least significant bit first: CRC-16/KERMIT and CRC-16/X-25. */
static inline uint16_t expert_ccitt(uint16_t sum, uint8_t byte) {
    byte = (uint8_t)(byte ^ sum);
    byte = (uint8_t)(byte ^ (byte << 4));
    return (uint16_t)((sum >> 8 | byte << 8) ^ (byte >> 4) ^ (byte << 3));
}
#endif

/* CRC-32 of the sixteen values of four bits; `late` where four other bits follow. */
static const uint32_t expert_crc32_bits[16] EXPERT_FLASH = {
    0x00000000u, 0x1DB71064u, 0x3B6E20C8u, 0x26D930ACu, 0x76DC4190u, 0x6B6B51F4u,
    0x4DB26158u, 0x5005713Cu, 0xEDB88320u, 0xF00F9344u, 0xD6D6A3E8u, 0xCB61B38Cu,
    0x9B64C2B0u, 0x86D3D2D4u, 0xA00AE278u, 0xBDBDF21Cu};

#if defined(__AVR__)
/* Shifts by four bits are slow here, those by eight are none: the halves of a byte have a table each. */
static const uint32_t expert_crc32_late[16] EXPERT_FLASH = {
    0x00000000u, 0x77073096u, 0xEE0E612Cu, 0x990951BAu, 0x076DC419u, 0x706AF48Fu,
    0xE963A535u, 0x9E6495A3u, 0x0EDB8832u, 0x79DCB8A4u, 0xE0D5E91Eu, 0x97D2D988u,
    0x09B64C2Bu, 0x7EB17CBDu, 0xE7B82D07u, 0x90BF1D91u};

static inline uint32_t expert_crc32(uint32_t sum, uint8_t byte) {
    byte = (uint8_t)(byte ^ sum);
    return sum >> 8 ^ pgm_read_dword(&expert_crc32_late[byte & 15u]) ^
           pgm_read_dword(&expert_crc32_bits[byte >> 4]);
}
#else
static inline uint32_t expert_crc32(uint32_t sum, uint8_t byte) {
    sum ^= byte;
    sum = sum >> 4 ^ expert_crc32_bits[sum & 15u];
    return sum >> 4 ^ expert_crc32_bits[sum & 15u];
}
#endif

#endif
