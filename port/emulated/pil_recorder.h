/*
 * The recorder in the image for processor in the loop, over the board's UART: every cycle, or what follows the
 * watch's alarm.
 *
 * All calls do nothing until one of the first two.
 */
#ifndef PORT_EMULATED_PIL_RECORDER_H
#define PORT_EMULATED_PIL_RECORDER_H

#include "pil_wire.h"

/* frame: PIL_RECORD. cycle: whose variables are recorded. Returns 0 or an iqfoc_error_t. */
int32_t pil_recorder_start(const pil_frame_t *frame, const iqfoc_cycle_t *cycle);

/*
 * frame: PIL_RECORD_ALARM. From the alarm of this firmware's watch on, a second at 8 kHz: what was before it may
 * be of the drive as it was before the change, and would be diagnosed as a mixture.
 */
int32_t pil_recorder_at_alarm(const pil_frame_t *frame, const tuned_firmware_t *firmware);

/* A new stream begins. */
void pil_recorder_arm(void);

/* After the valley's handler. */
void pil_recorder_take(uint32_t status);

/* In the background: all that waits. */
void pil_recorder_drain(void);

/* Ends the stream, and waits until its end frame is out. */
void pil_recorder_finish(void);

#endif
