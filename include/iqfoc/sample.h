/* Input and output of a control cycle: a set of measurements, and a command. */
#ifndef IQFOC_SAMPLE_H
#define IQFOC_SAMPLE_H

#include "modulation.h"
#include "vector.h"

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* One set of measurements. Per unit and turns are IQ24. */
typedef struct iqfoc_sample {
    iqfoc_abc_t i; /* phase currents, per unit, into the motor; the port's scaling keeps each within +-15.9 */
    iqfoc_abc_t
        i_mean;     /* valley only: means of the phase currents over the cycle that ends; read if has_mean */
    iq24_t theta;   /* electrical angle at the sampling instant, turns */
    iq24_t speed;   /* electrical speed, turns per control cycle */
    iq24_t u_dc;    /* DC-link voltage, per unit of nominal */
    iq24_t instant; /* the sampling instant, cycles after the valley: 0 there, 0.5 at the peak; -0.25 ... 1 */
    uint32_t time;  /* the port's timer at the sampling instant, ticks; wraps */
    bool has_mean;  /* valley only: i_mean is valid (oversampling); otherwise the peak's sample is used */
    bool clipped;   /* a converter was at the end of its range */
} iqfoc_sample_t;

/* The inverter's state from the next valley on. */
typedef struct iqfoc_command {
    iqfoc_duties_t duties; /* IQ24, 0 ... 1 */
    bool gates;            /* false: all switches off, whatever the duties say */
} iqfoc_command_t;

#ifdef __cplusplus
}
#endif

#endif
