/* Physical to per unit and back (per_unit.h). */
#include "per_unit.h"

#include "iqfoc/params.h"

per_unit per_unit_of(const motor *m)
{
    const per_unit base = {IQFOC_I_BASE(m->I_rated_A_rms), m->u_dc_V, 1.0 / m->f_pwm_Hz};
    return base;
}

iq24_t iq24_from_double(double x)
{
    const double scaled = nearbyint(x * (double)IQ24_ONE);
    if (scaled >= (double)IQ24_MAX) {
        return IQ24_MAX;
    }
    return scaled <= (double)IQ24_MIN ? IQ24_MIN : (iq24_t)scaled;
}

double iq24_to_double(iq24_t x)
{
    return (double)x / (double)IQ24_ONE;
}

iq24_t turns_from_rad(double theta_rad)
{
    return iq24_from_double(remainder(theta_rad / VEC_TWO_PI, 1.0));
}

iq24_t turns_from_speed(double omega_e_rad_s, double T_s)
{
    return iq24_from_double(omega_e_rad_s * T_s / VEC_TWO_PI);
}

iqfoc_ab_t ab_from_complex(double complex x, double base)
{
    const iqfoc_ab_t v = {iq24_from_double(creal(x) / base), iq24_from_double(cimag(x) / base)};
    return v;
}

double complex complex_from_ab(iqfoc_ab_t v, double base)
{
    return base * vec_complex(iq24_to_double(v.alpha), iq24_to_double(v.beta));
}

double complex complex_from_dq(iqfoc_dq_t v, double base)
{
    return base * vec_complex(iq24_to_double(v.d), iq24_to_double(v.q));
}
