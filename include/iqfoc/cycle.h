/*
 * The control cycle: what an interrupt calls at the carrier valley and at its peak.
 *
 *     valley t_k          peak t_k + T/2                    valley t_k + T
 *        |  sample i, theta    |  sample i, theta                  |
 *        |  mean, prediction   |  control, modulation -> duties    |  the duties act from here on, for a cycle
 *
 * Pure: a function of (state, sample) to (state, command); only a port touches registers. Time is an
 * argument: each sample says when it was taken, and the peak is told the middle of the span in which its
 * voltage will act.
 *
 * There is one cycle. By which methods it predicts, feeds back, controls and modulates is iqfoc_methods_t:
 * iqfoc/cycle_steps.h has the steps inline, and a drive that names its methods in a constant is compiled
 * without the others. iqfoc_cycle_valley and iqfoc_cycle_peak are the same steps ready made, for the papers'
 * methods: feedback and modulation are looked up in the configuration, and may change while it runs.
 *
 * Timing and data that are not what they should be set sticky status bits. Those in `trips` stop the drive:
 * the command becomes the safe one, the integrators are reset, and it stays so until iqfoc_cycle_clear.
 */
#ifndef IQFOC_CYCLE_H
#define IQFOC_CYCLE_H

#include "current_control.h"
#include "error.h"
#include "methods.h"
#include "modulation.h"
#include "overmodulation.h"
#include "predictor.h"
#include "rotor.h"
#include "sample.h"
#include "vector.h"

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Sticky status bits. */
#define IQFOC_STATUS_MISSED         UINT32_C(0x0001) /* two valleys or peaks in a row, or too long a cycle */
#define IQFOC_STATUS_LATE           UINT32_C(0x0002) /* command later than `deadline_ticks` after its sample */
#define IQFOC_STATUS_STALE          UINT32_C(0x0004) /* sample older than `stale_ticks` when the call began */
#define IQFOC_STATUS_SAMPLE_CLIPPED UINT32_C(0x0008) /* the port: a converter was at the end of its range */
#define IQFOC_STATUS_OVERCURRENT    UINT32_C(0x0010) /* a current component beyond `current_limit` */
#define IQFOC_STATUS_OVERSPEED      UINT32_C(0x0020) /* |speed| above 1/3 turn per cycle: held to it */
#define IQFOC_STATUS_VOLTAGE_LIMIT  UINT32_C(0x0040) /* the modulator shortened the voltage */
#define IQFOC_STATUS_DC_LINK        UINT32_C(0x0080) /* u_dc outside 0.5 ... 1.5 of nominal: held to it */
#define IQFOC_STATUS_NO_INTERVAL    UINT32_C(0x0100) /* corrected mean before a whole interval was seen */

/* What stands at the inverter when the drive is tripped or not enabled. */
typedef enum iqfoc_safe_state {
    IQFOC_SAFE_GATES_OFF,    /* all six switches off */
    IQFOC_SAFE_SHORT_CIRCUIT /* all low-side switches on: for machines whose EMF exceeds the DC link */
} iqfoc_safe_state_t;

/*
 * One set of parameters. The caller owns it, and leaves it alone while the cycle has it: to change a value in
 * a drive that runs, a slower task fills another set and offers it (iqfoc_cycle_offer).
 */
typedef struct iqfoc_cycle_config {
    iqfoc_predictor_t predictor;
    iqfoc_current_control_gains_t gains;
    iqfoc_feedback_t feedback; /* these two of the ready-made cycle */
    iqfoc_modulation_t modulation;
    iqfoc_safe_state_t safe_state;
    iq24_t span_max;           /* for iqfoc_modulate: 0 < span_max <= 1 */
    iq24_t current_limit;      /* per unit: 0 < current_limit <= 16, of alpha and of beta; to 1 LSB */
    uint32_t period_ticks;     /* control cycle T in the port's ticks; 0 switches the checks of time off */
    uint32_t tolerance_ticks;  /* a cycle longer than period + tolerance, at most 2^31 - 1, was missed */
    uint32_t stale_ticks;      /* a sample older than this when a call begins is stale */
    uint32_t deadline_ticks;   /* from the peak's sample to its finished command: later is late */
    uint32_t trips;            /* status bits that stop the drive */
    iqfoc_methods_data_t data; /* what methods beyond the papers' need; nothing where none of them is used */
} iqfoc_cycle_config_t;

/* The state. Read what you like; write only i_ref and enabled, between calls. */
typedef struct iqfoc_cycle {
    const iqfoc_cycle_config_t *config; /* in force in the cycle that runs */
    const iqfoc_cycle_config_t *next;   /* in force from the next valley on */
    const iqfoc_cycle_config_t *volatile offered;
    uint32_t phase;            /* which of valley and peak is due: IQFOC_CYCLE_DUE_... */
    uint32_t valley_time;      /* ticks of the last valley's sample */
    uint32_t status;           /* sticky bits */
    bool enabled;              /* false: the safe output, integrators held at zero */
    bool tripped;              /* a bit of config->trips was set; iqfoc_cycle_clear ends it */
    bool corrected;            /* i_corrected_dq is of the cycle that ended at the last valley */
    iqfoc_dq_t i_ref;          /* reference of the current, per unit: |component| <= 32 */
    iqfoc_dq_t i_dq;           /* the feedback: of the last peak, or the mean that the last valley gave */
    iqfoc_dq_t u_dq;           /* what the PI controller asked for at the last peak */
    iqfoc_ab_t u_ab;           /* what the modulator could make of it: acts from the next valley */
    iqfoc_ab_t u_now;          /* the voltage of the cycle that runs */
    iqfoc_ab_t i_valley;       /* sample of the last valley */
    iqfoc_ab_t i_next;         /* prediction for the next valley */
    iqfoc_ab_t error;          /* last valley's sample less its prediction */
    iqfoc_dq_t i_corrected_dq; /* mean of the cycle that ended at the last valley, if `corrected` */
    iqfoc_ab_t i_peak;         /* sample of the last peak */
    iqfoc_rotor_t rotor;       /* of the last valley's speed: turns; the rest where a method needs it */
    iq24_t theta_valley;       /* angle of the last valley */
    iq24_t u_dc_inverse;       /* 1/u_dc, followed by a Newton step a cycle */
    iqfoc_current_control_t control;
    iqfoc_dq_t drift;       /* learnt by deadbeat control */
    iqfoc_abc_t duties_now; /* mean under modulation: duties of the cycle that runs, and of the next */
    iqfoc_abc_t duties_next;
    iqfoc_overmodulation_t over; /* of IQFOC_MODULATION_OVER */
} iqfoc_cycle_t;

/* What `phase` says: the top bit that no valley is due, the next that no peak is. */
#define IQFOC_CYCLE_DUE_VALLEY  UINT32_C(0x40000000)
#define IQFOC_CYCLE_DUE_PEAK    UINT32_C(0x80000000)
#define IQFOC_CYCLE_DUE_NOTHING UINT32_C(0xC0000000) /* before the first valley: nothing can be told yet */

/*
 * Starts disabled, with cleared status. config must outlive the cycle. Refused with the object untouched: what the
 * cycle runs on is then what it was, and not to be enabled if it was nothing. Where methods are named:
 * iqfoc_cycle_init_by (cycle_check.h), which sees to what they need.
 */
iqfoc_error_t iqfoc_cycle_init(iqfoc_cycle_t *cycle, const iqfoc_cycle_config_t *config);

/*
 * Another set of parameters for a drive that runs, from any task: checked as iqfoc_cycle_init does, and refused
 * with the cycle unchanged. It is taken as a whole at a valley, and in force from the one after: the command
 * that is computed in between is already meant for it, its angle for the middle of a period of its length. A
 * port whose carrier follows loads that length (iqfoc_cycle_next_ticks) with the same command.
 */
iqfoc_error_t iqfoc_cycle_offer(iqfoc_cycle_t *cycle, const iqfoc_cycle_config_t *config);

/* True once the offered set is in force: the set before it is free to be filled anew. */
bool iqfoc_cycle_taken(const iqfoc_cycle_t *cycle);

/* The length of the cycle that begins at the next valley, ticks; for the port, at the peak. */
uint32_t iqfoc_cycle_next_ticks(const iqfoc_cycle_t *cycle);

/* Ends a trip: clears the status bits, the integrators and the memory of earlier samples. */
void iqfoc_cycle_clear(iqfoc_cycle_t *cycle);

/*
 * At the carrier valley: prediction error of the cycle that ended, then prediction and mean of the one that
 * begins. now: the port's timer when the call began. Never fails; what is wrong shows in the status.
 */
void iqfoc_cycle_valley(iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample, uint32_t now);

/*
 * At the carrier peak: control and modulation. Returns the command for the span whose middle is output_mid,
 * in cycles after the last valley: 1.5 where duties act from the next valley for one cycle. 0 <= output_mid
 * <= 8.
 */
iqfoc_command_t iqfoc_cycle_peak(iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample, iq24_t output_mid,
                                 uint32_t now);

/*
 * After the peak's command was computed, before it is handed to the inverter: true if it came in time. If
 * not, the LATE bit is set; where that trips, the port must take the command that iqfoc_cycle_safe gives.
 */
bool iqfoc_cycle_in_time(iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample, uint32_t now);

/*
 * Another angle for the frame in which PI works, while the drive runs: from the one that start.h turns by itself to
 * a sensor's, or from one sensor to another. Voltage and current, and so the torque, stay as they are: the voltage
 * is turned by the difference of both angles, the integrators are set to what is left of it beside the decoupling,
 * which now has its EMF in place, and i_ref becomes the current as the new angle sees it.
 *
 * Ahead of a valley's handler. theta_before: the old angle of that valley, turns; sample: what the handler will get,
 * with the new angle and speed, |phases| <= 15.9; with `extended` among the methods, put right by
 * iqfoc_extension_sample. What deadbeat control has learnt of the wrong angle is forgotten.
 */
void iqfoc_cycle_hand_over(iqfoc_cycle_t *cycle, iq24_t theta_before, const iqfoc_sample_t *sample);

/* The safe command of a configuration. */
iqfoc_command_t iqfoc_cycle_safe(const iqfoc_cycle_config_t *config);

#ifdef __cplusplus
}
#endif

#endif
