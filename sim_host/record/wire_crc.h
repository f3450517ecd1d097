/* The marks and the check of the recorder's line (docs/recorder-format.md), for both directions. */
#ifndef SIM_HOST_RECORD_WIRE_CRC_H
#define SIM_HOST_RECORD_WIRE_CRC_H

#include <stddef.h>
#include <stdint.h>

enum { WIRE_END = 0xC0, WIRE_ESCAPE = 0xDB, WIRE_ESCAPE_END = 0xDC, WIRE_ESCAPE_ESC = 0xDD };

/* The CRC-32 of Ethernet and zip, bit by bit: a line is slower than this. */
static inline uint32_t wire_crc(const uint8_t *octets, size_t count)
{
    uint32_t crc = UINT32_MAX;
    for (size_t k = 0; k < count; k++) {
        crc ^= octets[k];
        for (int bit = 0; bit < 8; bit++) {
            crc = (crc & 1) != 0 ? crc >> 1 ^ 0xEDB88320 : crc >> 1;
        }
    }
    return ~crc;
}

#endif
