/*
 * The recorder writes chosen variables, cycle by cycle, into a ring in the caller's memory, and sends them over a
 * serial line.
 *
 * Call iqfoc_recorder_take in an interrupt, after the cycle, and iqfoc_recorder_octet in the background, whenever the
 * line is free. There is one writer, one reader and no lock. A line that is too slow loses rows, but the loss is
 * visible: each row carries the number of its cycle, and lost rows are counted on the wire.
 *
 * A CRC-32 ends each frame, of 4512 bits at most. It detects any three wrong bits of a frame's words, and any burst
 * of up to 32 bits. Of all other errors it misses one frame in 2^32 (4.3e9).
 *
 * docs/recorder-format.md is the format on the wire; `iqfoc record` makes a recording of it.
 */
#ifndef IQFOC_RECORDER_H
#define IQFOC_RECORDER_H

#include "error.h"
#include "iq24.h"

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define IQFOC_RECORDER_CHANNELS_MAX 16

/* Words of a request (docs/recorder-format.md), its CRC included. */
#define IQFOC_RECORDER_REQUEST_WORDS 8

/*
 * Meaning of a channel, by its number on the wire; the numbers never change. Host units: A, rad, rad/s, V, 1, degrees
 * C.
 */
typedef enum iqfoc_recorder_column {
    IQFOC_RECORDER_I_A = 1, /* sampled at the valley */
    IQFOC_RECORDER_I_B = 2,
    IQFOC_RECORDER_I_C = 3,
    IQFOC_RECORDER_I_ALPHA = 4, /* the same as a vector: two channels instead of three */
    IQFOC_RECORDER_I_BETA = 5,
    IQFOC_RECORDER_THETA_E = 6,
    IQFOC_RECORDER_OMEGA_E = 7,
    IQFOC_RECORDER_U_A = 8, /* mean voltage that acts during the cycle */
    IQFOC_RECORDER_U_B = 9,
    IQFOC_RECORDER_U_C = 10,
    IQFOC_RECORDER_U_ALPHA = 11,
    IQFOC_RECORDER_U_BETA = 12,
    IQFOC_RECORDER_D_A = 13, /* duties in force during the cycle */
    IQFOC_RECORDER_D_B = 14,
    IQFOC_RECORDER_D_C = 15,
    IQFOC_RECORDER_U_DC = 16,
    IQFOC_RECORDER_I_MID_A = 17, /* sampled at the peak */
    IQFOC_RECORDER_I_MID_B = 18,
    IQFOC_RECORDER_I_MID_C = 19,
    IQFOC_RECORDER_THETA_MECH = 20,
    IQFOC_RECORDER_TEMP = 21,
    IQFOC_RECORDER_STATUS_WORD = 22 /* status bits; IQFOC_RECORDER_STATUS_CHANNEL */
} iqfoc_recorder_column_t;

/* One recorded variable. Its value in host units is *source * mantissa / 2^shift. */
typedef struct iqfoc_recorder_channel {
    const int32_t *source;
    uint32_t column;  /* iqfoc_recorder_column_t */
    int32_t mantissa; /* not 0 */
    uint32_t shift;   /* 0 ... 62 */
} iqfoc_recorder_channel_t;

/*
 * Initialiser of a channel (source, column, mantissa, shift) of an iq24_t. 1.0 of that variable is `unit` in host
 * units. bits: the largest number with |unit| 2^bits below 2^31, for the finest scale.
 */
#define IQFOC_RECORDER_IQ24(variable, what, unit, bits)                                                      \
    {                                                                                                        \
        (variable), (what), IQ24_CAST_(int32_t, IQ24_RAISED_(unit, bits)), 24 + (bits)                       \
    }

/* Initialiser of the channel of status bits: those of iqfoc_recorder_take in any cycle since the row before. */
#define IQFOC_RECORDER_STATUS_CHANNEL(recorder)                                                              \
    {                                                                                                        \
        &(recorder).status, IQFOC_RECORDER_STATUS_WORD, 1, 0                                                 \
    }

typedef enum iqfoc_recorder_trigger {
    IQFOC_RECORDER_NOW,    /* records from the start until iqfoc_recorder_stop */
    IQFOC_RECORDER_STATUS, /* one full memory, around the moment when one of `status_bits` is set */
    IQFOC_RECORDER_RISES,  /* the same, around the moment when channel `channel` goes from below to above
                              `level` */
    IQFOC_RECORDER_FALLS   /* from above to below */
} iqfoc_recorder_trigger_t;

typedef struct iqfoc_recorder_config {
    iqfoc_recorder_channel_t channels[IQFOC_RECORDER_CHANNELS_MAX];
    uint32_t channel_count;   /* 1 ... IQFOC_RECORDER_CHANNELS_MAX */
    uint32_t decimation;      /* a row every so many cycles, >= 1 */
    uint32_t period_mantissa; /* control cycle in seconds: mantissa / 2^shift; not 0 */
    uint32_t period_shift;    /* 0 ... 62 */
    iqfoc_recorder_trigger_t trigger;
    uint32_t status_bits;
    uint32_t channel;
    int32_t level;    /* in the variable's own scale */
    iq24_t pre_share; /* share of the memory for rows before the trigger: 0 ... 1, exclusive of 1 */
} iqfoc_recorder_config_t;

/* The part of the configuration that a request over the line may change: iqfoc_recorder_config_t's members. */
typedef struct iqfoc_recorder_setting {
    iqfoc_recorder_trigger_t trigger;
    uint32_t status_bits;
    uint32_t channel;
    int32_t level;
    iq24_t pre_share;
    uint32_t decimation;
} iqfoc_recorder_setting_t;

/* The state: read and write it only through the functions below. */
typedef struct iqfoc_recorder {
    const iqfoc_recorder_config_t *config;
    iqfoc_recorder_setting_t setting; /* the configuration's, then the last request's */
    volatile int32_t *memory;
    uint32_t row_words; /* number of the cycle, then the channels */
    uint32_t capacity;  /* rows */
    uint32_t pre_rows;
    uint32_t stream; /* number of times that it was armed */
    volatile uint32_t phase;
    /* The writer's. */
    volatile uint32_t written; /* rows, ever; wraps */
    uint32_t write_slot;
    uint32_t cycle;         /* calls since it was armed */
    uint32_t until_next;    /* cycles to the next row */
    uint32_t still_to_take; /* rows still to record after a trigger */
    uint32_t last_status;
    int32_t last_level;
    bool before_known;
    int32_t status;         /* bits since the last row */
    volatile uint32_t lost; /* rows lost because the ring was full */
    /* The reader's. */
    volatile uint32_t read; /* rows, ever; wraps */
    uint32_t read_slot;
    uint32_t sequence;   /* of frames */
    uint32_t frame_type; /* 0: between frames */
    uint32_t frame_words;
    uint32_t frame_rows;
    uint32_t frame_lost;
    uint32_t rows_sent;
    uint32_t frames_to_header; /* row frames until the header is repeated */
    uint32_t word;             /* that goes out */
    uint32_t word_index;
    uint32_t octet_index;
    uint32_t escaped; /* second octet of an escape, or 0 */
    uint32_t crc;
    bool end_sent;
    uint32_t frames_owed; /* after a request: 2: answer and header, 1: header */
    /* A request. */
    uint32_t request[IQFOC_RECORDER_REQUEST_WORDS];
    uint32_t request_octets;
    bool request_escape;
    bool request_broken;
    bool request_waits; /* a whole one, for iqfoc_recorder_obey */
    uint32_t request_sequence;
    int32_t request_error; /* iqfoc_error_t */
} iqfoc_recorder_t;

/*
 * words: length of memory. config and memory must outlive the recorder. It starts idle. Ahead of the first interrupt
 * that calls iqfoc_recorder_take.
 */
iqfoc_error_t iqfoc_recorder_init(iqfoc_recorder_t *recorder, const iqfoc_recorder_config_t *config,
                                  int32_t *memory, uint32_t words);

/*
 * Restarts the recording and drops rows that are not sent yet. From the background, not while an interrupt may call
 * iqfoc_recorder_take.
 */
void iqfoc_recorder_arm(iqfoc_recorder_t *recorder);

/* Ends the recording: the rows in memory are still sent, then the end frame. From the background. */
void iqfoc_recorder_stop(iqfoc_recorder_t *recorder);

/* Records one cycle. status: the cycle's status bits. From the cycle's interrupt only. */
void iqfoc_recorder_take(iqfoc_recorder_t *recorder, uint32_t status);

/*
 * The next octet for the line, 0 ... 255, or -1: nothing to send now. From the background only, or from the line's
 * interrupt only.
 */
int32_t iqfoc_recorder_octet(iqfoc_recorder_t *recorder);

/* True once all rows and the end frame are sent. From the background. */
bool iqfoc_recorder_finished(const iqfoc_recorder_t *recorder);

/*
 * An octet that the line brings, 0 ... 255: a request to stop, or to arm with another trigger (docs/recorder-format.md).
 * Anything else on the line is passed over, and so is all that comes while a request waits. From where
 * iqfoc_recorder_octet is called.
 */
void iqfoc_recorder_receive(iqfoc_recorder_t *recorder, uint32_t octet);

/*
 * True if a request waits and no frame is under way: call iqfoc_recorder_obey. Until then iqfoc_recorder_octet begins no
 * frame. From the background.
 */
bool iqfoc_recorder_requested(const iqfoc_recorder_t *recorder);

/*
 * Carries out the request that waits. An answer is the next frame, and a header follows it, also of a recorder that
 * waits for its trigger. What iqfoc_recorder_init would refuse changes nothing, and the answer gives the error, which is
 * also returned: IQFOC_ERROR_TRIGGER, or IQFOC_ERROR_PERIOD for decimation 0. IQFOC_OK without a request. Calling context as for
 * iqfoc_recorder_arm.
 */
iqfoc_error_t iqfoc_recorder_obey(iqfoc_recorder_t *recorder);

#ifdef __cplusplus
}
#endif

#endif
