/*
 * The control cycle: the functions that the interrupts at the carrier valley and at the carrier peak call.
 *
 *     valley t_k          peak t_k + T/2                    valley t_k + T
 *        |  sample i, theta    |  sample i, theta                  |
 *        |  mean, prediction   |  control, modulation -> duties    |  the duties act from here for one cycle
 *
 * The cycle is pure: it maps (state, sample) to (state, command), and only a port touches registers. Time is an
 * argument: each sample carries its time. The peak's call gets output_mid, the middle of the time in which its
 * voltage will act.
 *
 * iqfoc_methods_t selects the methods of prediction, feedback, control and modulation. iqfoc/cycle_steps.h has the
 * steps inline: if a drive names its methods in a constant, the compiler leaves out all others. iqfoc_cycle_valley
 * and iqfoc_cycle_peak are the same steps ready made, for the papers' methods. They read feedback and modulation from
 * the configuration, which may change while the drive runs.
 *
 * Wrong timing and wrong data set sticky status bits. A bit of `trips` stops the drive: the command becomes the safe
 * one, and the integrators are reset. The drive stays stopped until iqfoc_cycle_clear.
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
#define IQFOC_STATUS_ANGLE_LOST     UINT32_C(0x0200) /* sensorless.h: the observer in use is not locked */

/* State of the inverter when the drive is tripped or not enabled. */
typedef enum iqfoc_safe_state {
    IQFOC_SAFE_GATES_OFF,    /* all six switches off */
    IQFOC_SAFE_SHORT_CIRCUIT /* all low-side switches on: for machines whose EMF exceeds the DC link */
} iqfoc_safe_state_t;

/*
 * One set of parameters. The caller owns it and does not change it while the cycle uses it. To change a value of a
 * running drive, a slower task fills another set and offers it (iqfoc_cycle_offer).
 */
typedef struct iqfoc_cycle_config {
    iqfoc_predictor_t predictor;
    iqfoc_current_control_gains_t gains;
    iqfoc_feedback_t
        feedback; /* of the ready-made cycle, and so is modulation; with named methods 0 or the same method */
    iqfoc_modulation_t modulation;
    iqfoc_safe_state_t safe_state;
    iq24_t span_max;           /* for iqfoc_modulate: 0 < span_max <= 1 */
    iq24_t current_limit;      /* per unit: 0 < current_limit <= 16, of alpha and of beta; to 1 LSB */
    uint32_t period_ticks;     /* control cycle T in the port's ticks; 0 only with `time_unchecked` */
    uint32_t tolerance_ticks;  /* a cycle longer than period + tolerance, at most 2^31 - 1, was missed */
    uint32_t stale_ticks;      /* a sample older than this when a call begins is stale */
    uint32_t deadline_ticks;   /* from the peak's sample to its finished command: later is late */
    uint32_t trips;            /* status bits that stop the drive */
    iqfoc_methods_data_t data; /* data of the methods beyond the papers'; zero if none of them is used */
    bool
        time_unchecked; /* for a simulation without time: no MISSED by time, LATE or STALE; period_ticks is 0 */
} iqfoc_cycle_config_t;

/* The state. All fields may be read. Write only i_ref and enabled, between calls. */
typedef struct iqfoc_cycle {
    const iqfoc_cycle_config_t *config; /* in force in the cycle that runs */
    const iqfoc_cycle_config_t *next;   /* in force from the next valley on */
    const iqfoc_cycle_config_t *volatile offered;
    uint32_t phase;            /* next call that is due, valley or peak: IQFOC_CYCLE_DUE_... */
    uint32_t valley_time;      /* ticks of the last valley's sample */
    uint32_t status;           /* sticky bits */
    uint32_t raised;           /* bits set since the last clear, for iqfoc_cycle_clear */
    bool enabled;              /* false: the safe output, integrators held at zero */
    bool tripped;              /* a bit of config->trips was set; iqfoc_cycle_clear resets it */
    bool corrected;            /* i_corrected_dq holds for the cycle that ended at the last valley */
    iqfoc_dq_t i_ref;          /* reference of the current, per unit: |component| <= 32 */
    iqfoc_dq_t i_dq;           /* feedback: the sample of the last peak, or the mean from the last valley */
    iqfoc_dq_t u_dq;           /* voltage that the PI controller requested at the last peak */
    iqfoc_ab_t u_ab;           /* voltage after the modulator's limits: acts from the next valley */
    iqfoc_ab_t u_now;          /* voltage of the present cycle */
    iqfoc_ab_t i_valley;       /* sample of the last valley */
    iqfoc_ab_t i_next;         /* prediction for the next valley */
    iqfoc_ab_t error;          /* prediction error: last valley's sample minus its prediction */
    iqfoc_dq_t i_corrected_dq; /* mean current of the cycle that ended at the last valley, if `corrected` */
    iqfoc_ab_t i_peak;         /* sample of the last peak */
    iqfoc_rotor_t
        rotor; /* at the last valley's speed: turns always, the other fields if a method needs them */
    iq24_t theta_valley; /* angle of the last valley */
    iq24_t u_dc_inverse; /* 1/u_dc, updated by one Newton step per cycle */
    iqfoc_current_control_t control;
    iqfoc_dq_t drift; /* disturbance estimate of deadbeat control: current per cycle */
    iqfoc_abc_t
        duties_now; /* IQFOC_FEEDBACK_MODULATED_MEAN: duties of the present cycle, and of the next one */
    iqfoc_abc_t duties_next;
    iqfoc_overmodulation_t over; /* of IQFOC_MODULATION_OVER */
} iqfoc_cycle_t;

/* Values of `phase`. Bit 31: no valley is due. Bit 30: no peak is due. */
#define IQFOC_CYCLE_DUE_VALLEY  UINT32_C(0x40000000)
#define IQFOC_CYCLE_DUE_PEAK    UINT32_C(0x80000000)
#define IQFOC_CYCLE_DUE_NOTHING UINT32_C(0xC0000000) /* before the first valley */

/*
 * Initialises the cycle: disabled, with cleared status. config must outlive the cycle. Returns an error and leaves
 * the object unchanged if the configuration is refused; do not enable a cycle that was never initialised. For named
 * methods call iqfoc_cycle_init_by (cycle_check.h), which also checks their data. Call it only ahead of the first
 * interrupt.
 */
iqfoc_error_t iqfoc_cycle_init(iqfoc_cycle_t *cycle, const iqfoc_cycle_config_t *config);

/*
 * Offers another set of parameters to a running drive. It is checked as in iqfoc_cycle_init; if it is refused, the
 * cycle is unchanged. A valley accepts the whole set, and the set is in force from the valley after that one. The
 * command computed in between is already made for the new period: its angle is that of the middle of the new period.
 * A port with a variable carrier frequency loads that period (iqfoc_cycle_next_ticks) together with the command. From
 * any task.
 */
iqfoc_error_t iqfoc_cycle_offer(iqfoc_cycle_t *cycle, const iqfoc_cycle_config_t *config);

/*
 * Both without the check of `feedback` and `modulation`, for iqfoc_cycle_init_by and iqfoc_cycle_offer_by. Same
 * contexts.
 */
iqfoc_error_t iqfoc_cycle_init_named(iqfoc_cycle_t *cycle, const iqfoc_cycle_config_t *config);
iqfoc_error_t iqfoc_cycle_offer_named(iqfoc_cycle_t *cycle, const iqfoc_cycle_config_t *config);

/* True once the offered set is in force: the caller may then refill the set before it. From any task. */
bool iqfoc_cycle_taken(const iqfoc_cycle_t *cycle);

/*
 * Length of the cycle that begins at the next valley, ticks. A port with a variable carrier frequency calls it in the
 * peak's interrupt.
 */
uint32_t iqfoc_cycle_next_ticks(const iqfoc_cycle_t *cycle);

/*
 * Resets a trip. It clears the status bits. If the drive is tripped or not enabled, it also clears the integrators
 * and the memory of earlier samples. The output then stays safe until the first peak after a valley.
 *
 * From a task or from the cycle's interrupt. An interrupt may come at any instruction. A fault that it raises after
 * the store to `tripped` keeps the drive tripped, with its status bit.
 */
void iqfoc_cycle_clear(iqfoc_cycle_t *cycle);

/*
 * At the carrier valley: prediction error of the cycle that ended, then prediction and mean of the cycle that begins.
 * now: the port's timer when the call began. It cannot fail: each fault sets a status bit. From the valley's
 * interrupt only.
 *
 * Returns true if the drive is tripped: write iqfoc_cycle_safe to the inverter at once.
 */
bool iqfoc_cycle_valley(iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample, uint32_t now);

/*
 * At the carrier peak: control and modulation. Returns the command for the time whose middle is output_mid, in cycles
 * after the last valley: 1.5 if duties act from the next valley for one cycle. 0 <= output_mid <= 8. now: the port's
 * timer when the call began. From the peak's interrupt only.
 */
iqfoc_command_t iqfoc_cycle_peak(iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample, iq24_t output_mid,
                                 uint32_t now);

/*
 * Checks the deadline after the peak's command was computed and before it is written to the inverter: true if it is
 * in time. Otherwise it sets the LATE bit; if LATE trips, the port must write the command of iqfoc_cycle_safe. now:
 * the port's timer. From the peak's interrupt only.
 */
bool iqfoc_cycle_in_time(iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample, uint32_t now);

/*
 * Changes the angle of the PI controller's frame while the drive runs: from the open-loop angle of start.h to a
 * sensor's, or from one sensor to another. Voltage and current, and so the torque, do not change. The voltage is
 * turned by the difference of the two angles. The integrators are set to that voltage minus the decoupling, which now
 * contains the EMF. i_ref becomes the current in the new frame.
 *
 * Call it ahead of a valley's handler, in the valley's interrupt. theta_before: the old angle of that valley, turns.
 * sample: the handler's sample with the new angle and speed, |phases| <= 15.9; if the methods have `extended`,
 * corrected by iqfoc_extension_sample. The disturbance estimate of deadbeat control is set to zero.
 */
void iqfoc_cycle_hand_over(iqfoc_cycle_t *cycle, iq24_t theta_before, const iqfoc_sample_t *sample);

/* The safe command of a configuration. From any context. */
iqfoc_command_t iqfoc_cycle_safe(const iqfoc_cycle_config_t *config);

#ifdef __cplusplus
}
#endif

#endif
