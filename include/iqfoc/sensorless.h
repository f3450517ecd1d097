/*
 * A drive without an angle sensor: the angle of the control cycle's samples comes from a sensor, from the open-loop
 * start or from the observer, and changes between them without a step of the torque. docs/sensorless.md is the guide.
 *
 *     IQFOC_ANGLE_MEASURED  the sample's own angle and speed; the observer runs next to them
 *     IQFOC_ANGLE_START     start.h aligns and turns the rotor. From speed_min of the observer on, the observer seeks.
 *                           In the stage OPEN_LOOP, once the observer is locked, the source becomes OBSERVED
 *     IQFOC_ANGLE_CATCH     the machine turns at an unknown angle: the cycle controls the current to 0 in the stationary
 *                           frame, while the observer seeks. Once it is locked, the source becomes OBSERVED. The
 *                           current is at most that of a sudden short circuit, 2 psi_f/L
 *     IQFOC_ANGLE_OBSERVED  the observer's angle and speed
 *
 * Call the two functions between the port's read and the cycle's handler:
 *
 *     valley:  iqfoc_hal_read_valley(hal, &sample);
 *              iqfoc_sensorless_valley(&sensorless, &cycle, &sample);
 *              iqfoc_cycle_valley(&cycle, &sample, now);
 *     peak:    iqfoc_hal_read_peak(hal, &sample);
 *              iqfoc_sensorless_peak(&sensorless, &sample);
 *              command = iqfoc_cycle_peak(&cycle, &sample, IQFOC_HAL_OUTPUT_MID, now);
 *
 * A drive without this header pays nothing for it. The methods of the cycle may be any without `extended`: its angle
 * corrections are those of a sensor. One update a period.
 *
 * While the source is OBSERVED and the observer is not locked, each valley sets IQFOC_STATUS_ANGLE_LOST, which trips
 * the drive if it is in config->trips. observer.status has the reason. Without a trip the drive goes on with the angle
 * of the observer, which seeks.
 *
 * All functions from the cycle's interrupts, or with them masked.
 */
#ifndef IQFOC_SENSORLESS_H
#define IQFOC_SENSORLESS_H

#include "cycle.h"
#include "extension.h"
#include "observer.h"
#include "start.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum iqfoc_angle_source {
    IQFOC_ANGLE_MEASURED,
    IQFOC_ANGLE_START,
    IQFOC_ANGLE_CATCH,
    IQFOC_ANGLE_OBSERVED
} iqfoc_angle_source_t;

/* The state. All fields may be read. */
typedef struct iqfoc_sensorless {
    iqfoc_observer_t observer;
    iqfoc_start_t start;
    const iqfoc_start_config_t *start_config;
    const iqfoc_extension_t
        *acting; /* of the voltage that acts (iqfoc_extension_acting); NULL: the commanded one */
    iqfoc_angle_source_t source;
    iqfoc_angle_source_t wanted; /* MEASURED or OBSERVED: the source once it can be had */
    iqfoc_ab_t i_peak;           /* sample of the last peak */
    uint32_t on; /* valleys in a row with the drive enabled, up to 3: then the voltage is known */
    iq24_t
        difference; /* angle of the observer minus that of the sample at the last valley, -1/2 ... 1/2 turn */
} iqfoc_sensorless_t;

/*
 * The voltage that acts in a cycle: k_u u less what the legs lose, each leg at the current of its two switching edges. Stationary
 * frame, per unit. docs/sensorless.md has the derivation.
 *
 *     d    = 1/2 + (u_x - (max + min)/2)/u_dc                    a leg's duty, by its phase voltage u_x
 *     r    = (sum of max(0, u_x - u_y)/3 - u_x d)/2              flux of the ripple at the edges; y: the other legs
 *     i(t)                                                       the parabola through the phase's three samples
 *     lost = (f(l i((1 - d) T/2) - r) + f(l i((1 + d) T/2) + r))/2   f(x) = 3 x, held to +-v_dead
 *
 * A current below v_dead T/(3 L) passes zero within the dead time, and the edge loses a part of it. A leg with a pulse shorter
 * than |v_dead|/u_dc, as in six-step, has no edge and loses nothing. The knee of acting is not used.
 *
 * acting: checked by iqfoc_extension_check, or NULL: the result is u. machine: checked by iqfoc_flux_predictor_check, but k_d and k_q, which are
 * not used; l is the mean of its l_d and l_q. NULL: the edges are not known, and the result is the mean of iqfoc_extension_acting at the
 * mean current of each half, with the knee. u: commanded, |component| <= 2. 0 < u_dc_inverse <= 2. i: samples at the cycle's start,
 * middle and end, |component| <= 8. Largest error of 300000 drawn, with u within the link: 6 LSB and 36 l LSB; without
 * a machine 2.6 LSB and |v_dead knee_inverse| LSB. The valley and `iqfoc observe` use this function. It has no state, so any context may
 * call it.
 */
iqfoc_ab_t iqfoc_sensorless_acting(const iqfoc_extension_t *acting, const iqfoc_flux_predictor_t *machine,
                                   iqfoc_ab_t u, iq24_t u_dc_inverse, const iqfoc_ab_t i[3]);

/*
 * Checks the configurations, which must outlive the object; then the source is MEASURED. acting: checked by
 * iqfoc_extension_check, or NULL. start: NULL if iqfoc_sensorless_start is never called. Errors: those of
 * iqfoc_observer_init and iqfoc_start_init. Ahead of the first interrupt.
 */
iqfoc_error_t iqfoc_sensorless_init(iqfoc_sensorless_t *sensorless, const iqfoc_observer_config_t *observer,
                                    const iqfoc_start_config_t *start, const iqfoc_extension_t *acting);

/*
 * From standstill: begins the start at its first stage. |speed_end| must exceed speed_min of the observer; otherwise
 * the drive stays in OPEN_LOOP. The start writes i_ref until the source is OBSERVED.
 */
void iqfoc_sensorless_start(iqfoc_sensorless_t *sensorless);

/*
 * A machine that turns, at any angle. speed: its speed, of the right sign and within +-50 %; held to
 * IQFOC_ROTOR_SPEED_MAX. Enable the drive after it.
 */
void iqfoc_sensorless_catch(iqfoc_sensorless_t *sensorless, iq24_t speed);

/*
 * Asks for the sensor's angle or the observer's: from the next valley on, or from the first one at which the observer is
 * locked. From START and CATCH the change is iqfoc_cycle_hand_over, so i_ref becomes the current in the new frame.
 * Between MEASURED and OBSERVED the current's angle changes by `difference`, and i_ref stays.
 */
static inline void iqfoc_sensorless_use(iqfoc_sensorless_t *sensorless, bool observed)
{
    sensorless->wanted = observed ? IQFOC_ANGLE_OBSERVED : IQFOC_ANGLE_MEASURED;
}

/*
 * Ahead of the valley's handler: steps the observer by the cycle that ended, changes the source, and sets angle and
 * speed of the sample. Its currents are held to +-8 for the observer. A cycle in which the gates were off says nothing
 * about the voltage: the observer then starts again, at the sensor's angle if the source is MEASURED. If it is OBSERVED, it becomes CATCH.
 */
void iqfoc_sensorless_valley(iqfoc_sensorless_t *sensorless, iqfoc_cycle_t *cycle, iqfoc_sample_t *sample);

/* Ahead of the peak's handler: sets angle and speed of the sample. */
void iqfoc_sensorless_peak(iqfoc_sensorless_t *sensorless, iqfoc_sample_t *sample);

#ifdef __cplusplus
}
#endif

#endif
