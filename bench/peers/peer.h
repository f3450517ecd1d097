/*
 * The job that bench/peers.py counts in the functions of one library after another: two phase currents and an angle in, three duties out.
 *
 *     i = Park(Clarke(i_a, i_b)), e = i_ref - i, u = kp e + I, I += ki e, duties = min/max modulation of the inverse Park of u
 *
 * Per unit. The gains are exact in every number format here. No input comes near a limit of the voltage.
 */
#ifndef PEER_H
#define PEER_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define PEER_KP      (3.0 / 64.0)
#define PEER_KI      (1.0 / 2048.0)
#define PEER_I_REF_D 0.125
#define PEER_I_REF_Q (-0.0625)
#define PEER_U_DC    1.0

/* Each library's file in this folder defines these functions. Only peer_job is counted. */

/* Once, before the first job. */
void peer_start(void);
/* The next job's currents and angle, in IQ24 (turns): into the library's own number format. */
void peer_input(int32_t i_a, int32_t i_b, int32_t theta);
void peer_job(void);
/* The duties of the last job. */
void peer_duties(double duty[3]);

#ifdef __cplusplus
}
#endif

#endif
