/* A request to the recorder (wire_request.h). */
#include "wire_request.h"

#include "wire_crc.h"

enum { VERSION = 1, FRAME_ASK = 4, STOP = 4 };

static size_t escaped(uint8_t octet, uint8_t *out)
{
    if (octet == WIRE_END || octet == WIRE_ESCAPE) {
        out[0] = WIRE_ESCAPE;
        out[1] = octet == WIRE_END ? WIRE_ESCAPE_END : WIRE_ESCAPE_ESC;
        return 2;
    }
    out[0] = octet;
    return 1;
}

size_t wire_request(uint32_t sequence, const iqfoc_recorder_setting_t *setting,
                    uint8_t octets[WIRE_REQUEST_MAX])
{
    const iqfoc_recorder_setting_t none = {0};
    const iqfoc_recorder_setting_t *s = setting != NULL ? setting : &none;
    uint32_t words[IQFOC_RECORDER_REQUEST_WORDS] = {VERSION | FRAME_ASK << 8 | (sequence & 0xFFFF) << 16,
                                                    setting != NULL ? (uint32_t)s->trigger : STOP,
                                                    s->status_bits,
                                                    s->channel,
                                                    (uint32_t)s->level,
                                                    (uint32_t)s->pre_share,
                                                    s->decimation};
    enum { LAST = IQFOC_RECORDER_REQUEST_WORDS - 1 };
    uint8_t plain[4 * IQFOC_RECORDER_REQUEST_WORDS];
    size_t count = 0;
    octets[count++] = WIRE_END;
    for (size_t k = 0; k < sizeof plain; k++) {
        if (k == 4 * LAST) {
            words[LAST] = wire_crc(plain, k);
        }
        plain[k] = (uint8_t)(words[k / 4] >> (8 * (k % 4)));
        count += escaped(plain[k], &octets[count]);
    }
    octets[count++] = WIRE_END;
    return count;
}
