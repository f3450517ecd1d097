/*
 * The recorder in the image for processor in the loop: every cycle, over the board's UART.
 *
 * All calls do nothing until pil_recorder_start.
 */
#ifndef PORT_EMULATED_PIL_RECORDER_H
#define PORT_EMULATED_PIL_RECORDER_H

#include "pil_wire.h"

/* frame: PIL_RECORD. cycle: whose variables are recorded. Returns 0 or an iqfoc_error_t. */
int32_t pil_recorder_start(const pil_frame_t *frame, const iqfoc_cycle_t *cycle);

/* A new stream begins. */
void pil_recorder_arm(void);

/* After the valley's handler. */
void pil_recorder_take(uint32_t status);

/* In the background: all that waits. */
void pil_recorder_drain(void);

/* Ends the stream, and waits until its end frame is out. */
void pil_recorder_finish(void);

#endif
