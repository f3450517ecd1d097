/*
 * The firmware on an emulated processor, behind the same calls as the one linked into this program: processor
 * in the loop.
 */
#ifndef SIM_HOST_PIL_DRIVE_EMULATED_H
#define SIM_HOST_PIL_DRIVE_EMULATED_H

#include "drive/firmware.h"
#include "emulator.h"

#include "data/motor.h"

#include "pil_wire.h"

typedef struct drive_emulated {
    emulator machine;
    pil_decoder_t decoder;
    iqfoc_sample_t valley; /* kept, and sent with the peak's: until then nothing depends on the answer */
} drive_emulated;

typedef struct drive_emulated_choice {
    const char *target; /* "cortex-m4" or "rv32" */
    /* The ELF file; NULL: the one built with this program, build/TARGET/iqfoc_pil.elf. */
    const char *image;
    /* NULL; or a file, or a terminal (in both directions), for the octets of the UART over which the image records each cycle, or, with `at_alarm`, what
     * follows the alarm of the tuned firmware's watch. */
    const char *uart;
    bool at_alarm;
} drive_emulated_choice;

/* Starts the image. m: for the recorder's scales. False with *e set: no such target, image or emulator. */
bool drive_emulated_start(drive_emulated *d, const drive_emulated_choice *choice, const motor *m, error *e);

drive_firmware drive_firmware_emulated(drive_emulated *d);

/*
 * The tuned firmware in place of the cycle, restarted; drive_firmware_emulated's calls are then its. False with *e set:
 * refused.
 */
bool drive_emulated_tune(drive_emulated *d, const tuned_firmware_config_t *config, error *e);

/* What its watch has come to. */
bool drive_emulated_watched(drive_emulated *d, pil_watched_t *watched, error *e);

/* Lets the image end by itself, its recorder emptied. False with *e set if it does not. */
bool drive_emulated_finish(drive_emulated *d, error *e);

/* Kills the emulator. Safe on a zeroed struct. */
void drive_emulated_stop(drive_emulated *d);

#endif
