/*
 * Processor in the loop: the messages between the simulator and the firmware's image on an emulated board.
 *
 * One exchange per control cycle. A frame is a sync byte, a type, the type's fixed number of 32-bit words
 * (low byte first) and the CRC-32 of type and words. Both sides compile this file, so that they cannot
 * disagree. Any four wrong bits in the words and the CRC of a frame are found, and any burst of up to 32; of all
 * other damage one frame in 2^32 is taken for whole. A run ends at the first frame that is not.
 */
#ifndef PORT_EMULATED_PIL_WIRE_H
#define PORT_EMULATED_PIL_WIRE_H

#include "iqfoc/cycle.h"

#include "tuned_firmware.h"

#define PIL_SYNC 0x5A

/* Types of frames. */
#define PIL_START   1 /* to the image: a configuration; the drive starts again */
#define PIL_CYCLE   2 /* to the image: reference, valley's sample, peak's sample */
#define PIL_STARTED 3 /* from the image: iqfoc_error_t of the configuration */
#define PIL_COMMAND 4 /* from the image: the command, and the status */
#define PIL_GARBLED 5 /* from the image, its last: what came was no frame */
#define PIL_RECORD                                                                                           \
    6 /* to the image: record every cycle over the UART from the next start; answered by STARTED */
#define PIL_TUNE         7  /* to the image: as START, the tuned firmware in place of the cycle */
#define PIL_RECORD_ALARM 8  /* to the image: record one memory full from the watch's alarm on, likewise */
#define PIL_ASK          9  /* to the image: what has the watch of the tuned firmware seen? */
#define PIL_WATCHED      10 /* from the image: that */

#define PIL_CONFIG_WORDS 21
#define PIL_SAMPLE_WORDS 11
#define PIL_TUNE_WORDS   55
#define PIL_WORDS_MAX    PIL_TUNE_WORDS
/* Bytes of the longest frame. */
#define PIL_FRAME_MAX (1 + 1 + 4 * PIL_WORDS_MAX + 4)

typedef struct pil_frame {
    uint32_t type;
    uint32_t words; /* of data in use */
    int32_t data[PIL_WORDS_MAX];
} pil_frame_t;

/* What the image computes in a cycle. */
typedef struct pil_result {
    iqfoc_command_t command;
    uint32_t status;
} pil_result_t;

/* The frame's bytes, 0 ... 255 each; returns how many, at most PIL_FRAME_MAX. */
uint32_t pil_encode(const pil_frame_t *frame, uint8_t bytes[PIL_FRAME_MAX]);

/* Byte by byte. Zero-initialised; ready for the next frame after each that was whole or damaged. */
typedef struct pil_decoder {
    uint8_t bytes[PIL_FRAME_MAX];
    uint32_t count;
} pil_decoder_t;

typedef enum pil_decoded {
    PIL_MORE = 0,     /* wants the next byte */
    PIL_WHOLE = 1,    /* *frame is filled in */
    PIL_DAMAGED = -1, /* no sync, no such type, or the CRC is wrong */
} pil_decoded_t;

pil_decoded_t pil_decode(pil_decoder_t *decoder, uint32_t byte, pil_frame_t *frame);

/* What 1.0 per unit is in host units, and the cycle: each mantissa / 2^shift. */
typedef struct pil_bases {
    int32_t T_mantissa, T_shift;         /* s */
    int32_t I_mantissa, I_shift;         /* A */
    int32_t U_mantissa, U_shift;         /* V */
    int32_t omega_mantissa, omega_shift; /* rad/s of one turn per cycle */
} pil_bases_t;

/* type: PIL_RECORD or PIL_RECORD_ALARM. */
pil_frame_t pil_record_frame(uint32_t type, const pil_bases_t *bases);
void pil_record_read(const pil_frame_t *frame, pil_bases_t *bases);
pil_frame_t pil_start_frame(const iqfoc_cycle_config_t *config);
void pil_start_read(const pil_frame_t *frame, iqfoc_cycle_config_t *config);
pil_frame_t pil_cycle_frame(iqfoc_dq_t i_ref, const iqfoc_sample_t *valley, const iqfoc_sample_t *peak);
void pil_cycle_read(const pil_frame_t *frame, iqfoc_dq_t *i_ref, iqfoc_sample_t *valley,
                    iqfoc_sample_t *peak);
pil_frame_t pil_command_frame(const pil_result_t *result);
void pil_command_read(const pil_frame_t *frame, pil_result_t *result);
pil_frame_t pil_tune_frame(const tuned_firmware_config_t *config);
void pil_tune_read(const pil_frame_t *frame, tuned_firmware_config_t *config);

/* What a watch has come to: its members of the same names. */
typedef struct pil_watched {
    int32_t group; /* iqfoc_watch_group_t */
    uint32_t since;
    int32_t amount_q16;
} pil_watched_t;

pil_frame_t pil_watched_frame(const pil_watched_t *watched);
void pil_watched_read(const pil_frame_t *frame, pil_watched_t *watched);

#endif
