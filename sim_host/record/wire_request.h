/*
 * A request to the firmware's recorder over the line (docs/recorder-format.md): stop, or arm with another trigger.
 */
#ifndef SIM_HOST_RECORD_WIRE_REQUEST_H
#define SIM_HOST_RECORD_WIRE_REQUEST_H

#include "iqfoc/recorder.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Two marks, and each octet escaped. */
#define WIRE_REQUEST_MAX (2 + 8 * IQFOC_RECORDER_REQUEST_WORDS)

/* The octets of the request; returns how many. sequence: which the answer repeats, modulo 2^16. setting: NULL: stop. */
size_t wire_request(uint32_t sequence, const iqfoc_recorder_setting_t *setting,
                    uint8_t octets[WIRE_REQUEST_MAX]);

#endif
