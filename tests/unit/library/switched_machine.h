/*
 * A machine behind a switched inverter with dead time, in double, for the tests of the observer. It shares no code with
 * the library or the simulator: flux linkage in the stationary frame by Runge-Kutta between the switching edges.
 *
 * Units: voltage and current per unit, time in PWM periods, so that flux is voltage times periods. Angles in turns.
 */
#ifndef TESTS_UNIT_SWITCHED_MACHINE_H
#define TESTS_UNIT_SWITCHED_MACHINE_H

#include "reference_vectors.h"

typedef struct switched_machine {
    double r;
    double l_d;
    double l_q;
    double psi_f;
    double dead;        /* dead time, periods */
    double noise;       /* standard deviation of a sample of a phase */
    double step;        /* of the converter; 0: none */
    double complex psi; /* flux linkage */
    double theta;
    double speed; /* speed, turns per period */
    uint64_t seed;
} switched_machine;

static inline double complex turn_of(double turns)
{
    return cexp(I * TWO_PI * turns);
}

static inline double phase_of(double complex x, int leg)
{
    return creal(x * turn_of(-leg / 3.0));
}

static inline double complex vector_of(const double leg[3])
{
    return 2.0 / 3.0 * (leg[0] + leg[1] * turn_of(1.0 / 3.0) + leg[2] * turn_of(2.0 / 3.0));
}

static inline double complex switched_flux(const switched_machine *m, double complex i_dq, double theta)
{
    return turn_of(theta) * (m->psi_f + m->l_d * creal(i_dq) + I * m->l_q * cimag(i_dq));
}

static inline double complex switched_current(const switched_machine *m, double complex psi, double theta)
{
    const double complex x = psi * turn_of(-theta);
    return turn_of(theta) * ((creal(x) - m->psi_f) / m->l_d + I * cimag(x) / m->l_q);
}

static inline void switched_hold(switched_machine *m, double complex u, double time)
{
    const int parts = (int)ceil(time / 0.04) + 1;
    const double h = time / parts;
    for (int k = 0; k < parts; k++) {
        const double half = m->theta + 0.5 * h * m->speed;
        const double end = m->theta + h * m->speed;
        const double complex a = u - m->r * switched_current(m, m->psi, m->theta);
        const double complex b = u - m->r * switched_current(m, m->psi + 0.5 * h * a, half);
        const double complex c = u - m->r * switched_current(m, m->psi + 0.5 * h * b, half);
        const double complex d = u - m->r * switched_current(m, m->psi + h * c, end);
        m->psi += h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
        m->theta = end;
    }
    m->theta -= floor(m->theta);
}

/*
 * Half a period: from valley to peak the legs go high, from peak to valley low. A leg whose current flows the other way
 * follows its gate; otherwise it changes a dead time later.
 */
static inline void switched_half(switched_machine *m, const double duty[3], bool rising)
{
    double leg[3];
    double edge[3];
    bool waited[3] = {false, false, false};
    for (int k = 0; k < 3; k++) {
        leg[k] = rising ? 0.0 : 1.0;
        edge[k] = rising ? 0.5 * (1.0 - duty[k]) : 0.5 * duty[k];
    }
    double now = 0.0;
    while (now < 0.5) {
        int next = 0;
        for (int k = 1; k < 3; k++) {
            next = edge[k] < edge[next] ? k : next;
        }
        const double until = fmin(edge[next], 0.5);
        if (until > now) {
            switched_hold(m, vector_of(leg), until - now);
            now = until;
        }
        if (now >= 0.5) {
            return;
        }
        const double i = phase_of(switched_current(m, m->psi, m->theta), next);
        if (!waited[next] && (rising ? i > 0.0 : i < 0.0)) {
            waited[next] = true;
            edge[next] += m->dead;
        } else {
            leg[next] = rising ? 1.0 : 0.0;
            edge[next] = 1.0;
        }
    }
}

static inline double normal(uint64_t *seed)
{
    const double length = sqrt(-2.0 * log(1.0 - uniform(seed, 0.0, 1.0)));
    return length * cos(TWO_PI * uniform(seed, 0.0, 1.0));
}

static inline double complex switched_sample(switched_machine *m)
{
    const double complex i = switched_current(m, m->psi, m->theta);
    double phase[3];
    for (int k = 0; k < 3; k++) {
        phase[k] = phase_of(i, k) + m->noise * normal(&m->seed);
        phase[k] = m->step > 0.0 ? m->step * round(phase[k] / m->step) : phase[k];
    }
    return vector_of(phase);
}

/* Duties of a voltage, in the middle of the range; the voltage that they are, without dead time. */
static inline double complex switched_duties(double complex u, double duty[3])
{
    double low = 1.0;
    double high = -1.0;
    for (int k = 0; k < 3; k++) {
        duty[k] = phase_of(u, k);
        low = fmin(low, duty[k]);
        high = fmax(high, duty[k]);
    }
    for (int k = 0; k < 3; k++) {
        duty[k] = fmax(0.0, fmin(1.0, duty[k] + 0.5 - 0.5 * (low + high)));
    }
    return vector_of(duty);
}

/* The voltage that a dead time costs at these currents of the legs, with a straight line within the knee. */
static inline double complex switched_loss(double dead, double complex i, double knee)
{
    double leg[3];
    for (int k = 0; k < 3; k++) {
        leg[k] = dead * fmax(-1.0, fmin(1.0, phase_of(i, k) / knee));
    }
    return vector_of(leg);
}

#endif
