/*
 * The firmware on an emulated processor, behind the same calls as the one linked into this program: processor
 * in the loop.
 */
#ifndef SIM_HOST_PIL_DRIVE_EMULATED_H
#define SIM_HOST_PIL_DRIVE_EMULATED_H

#include "drive.h"
#include "emulator.h"

#include "pil_wire.h"

typedef struct drive_emulated {
    emulator machine;
    pil_decoder_t decoder;
    iqfoc_dq_t i_ref;
    iqfoc_sample_t
        valley; /* goes out with the peak's: what the plant does in between does not depend on it */
} drive_emulated;

/*
 * Starts the image of a target, "cortex-m4" or "rv32". image: the ELF file, or NULL for the one that was
 * built beside this program (build/<target>/iqfoc_pil.elf). False with *e set: unknown target, no image, no
 * emulator.
 */
bool drive_emulated_start(drive_emulated *d, const char *target, const char *image, error *e);

drive_firmware drive_firmware_emulated(drive_emulated *d);

/* Ends the emulator. Safe on a zeroed struct. */
void drive_emulated_stop(drive_emulated *d);

#endif
