/*
 * Firmware with the tuned controller (iqfoc/tuned_control.h) and the watch on its model (iqfoc/watch.h): what runs at
 * valley and peak. The image for processor in the loop runs it, and the host's trials link the same.
 */
#ifndef PORT_EMULATED_TUNED_FIRMWARE_H
#define PORT_EMULATED_TUNED_FIRMWARE_H

#include "iqfoc/adapt.h"
#include "iqfoc/extension.h"
#include "iqfoc/tuned_control.h"
#include "iqfoc/watch.h"

/* The firmware's data of the drive; 32-bit words throughout, as they go over the wire (pil_wire.h). */
typedef struct tuned_firmware_config {
    iqfoc_tuned_law_t law;
    int32_t extended; /* not 0: duties make good what the legs lose by `extension` */
    iqfoc_extension_t extension;
    int32_t watched; /* not 0: by `watch` */
    iqfoc_watch_config_t watch;
    int32_t adapted; /* not 0, and watched: the law follows resistance and magnet by `adapt` */
    iqfoc_adapt_config_t adapt;
} tuned_firmware_config_t;

/* Status bit: the watch has raised its alarm; up until the next start. */
#define TUNED_FIRMWARE_ALARM UINT32_C(1)

typedef struct tuned_firmware {
    tuned_firmware_config_t config;
    iqfoc_tuned_law_t law; /* in force */
    iqfoc_tuned_state_t state;
    /* The cycle that runs: duties times the DC link measured at its first valley. */
    iqfoc_ab_t u_now;
    iqfoc_ab_t share_next;   /* of the next cycle: its duties, over the DC link */
    iqfoc_sample_t sample;   /* of the last valley */
    iqfoc_abc_t high_now;    /* duties of the cycle that runs */
    iqfoc_command_t command; /* of the next */
    iqfoc_watch_t watch;
    iqfoc_adapt_t adapt;
    iqfoc_dq_t i_start, u_start; /* of the cycle that runs, seen from the rotor at its start */
    iq24_t link_before;          /* at the valley before; 0: none */
    uint32_t status;
} tuned_firmware_t;

/* config: of values within the ranges that the three headers state. */
void tuned_firmware_start(tuned_firmware_t *t, const tuned_firmware_config_t *config);

/* At the valley: t->command is then what is to act from the next one. i_ref: per unit. */
void tuned_firmware_valley(tuned_firmware_t *t, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample);
void tuned_firmware_peak(tuned_firmware_t *t, const iqfoc_sample_t *sample);

#endif
