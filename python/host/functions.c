/*
 * The library's functions over arrays: each is the library's own, called once for each element.
 *
 * Angles are given instead of sines and cosines, so that no argument, whatever its bits, leaves the range in which the
 * library's products are exact.
 */
#include "interface.h"

#include "iqfoc/iqfoc.h"
#include "per_unit.h"

#define IN(n)      in[n][k]
#define AB(n)      ((iqfoc_ab_t){IN(n), IN((n) + 1)})
#define DQ(n)      ((iqfoc_dq_t){IN(n), IN((n) + 1)})
#define ABC(n)     ((iqfoc_abc_t){IN(n), IN((n) + 1), IN((n) + 2)})
#define OUT(n, x)  out[n][k] = (x)
#define OUT_AB(x)  OUT(0, (x).alpha), OUT(1, (x).beta)
#define OUT_DQ(x)  OUT(0, (x).d), OUT(1, (x).q)
#define OUT_ABC(x) OUT(0, (x).a), OUT(1, (x).b), OUT(2, (x).c)

/* A function `each_NAME` over all elements. */
#define EACH(name, body)                                                                                     \
    static void each_##name(size_t n, const int32_t *const *in, int32_t *const *out)                         \
    {                                                                                                        \
        for (size_t k = 0; k < n; k++) {                                                                     \
            body;                                                                                            \
        }                                                                                                    \
    }

EACH(mul, OUT(0, iq24_mul_sat(IN(0), IN(1))))
EACH(div, OUT(0, iq24_div(IN(0), IN(1))))
EACH(sqrt, OUT(0, iq24_sqrt(IN(0))))
EACH(atan2, OUT(0, iq24_atan2(IN(0), IN(1))))
EACH(sincos, const iq24_sincos_t sc = iq24_sincos(IN(0)); OUT(0, sc.sin); OUT(1, sc.cos))

EACH(clarke2, const iqfoc_ab_t x = iqfoc_clarke2(IN(0), IN(1)); OUT_AB(x))
EACH(clarke3, const iqfoc_ab_t x = iqfoc_clarke3(ABC(0)); OUT_AB(x))
EACH(clarke_inverse, const iqfoc_abc_t x = iqfoc_clarke_inverse(AB(0)); OUT_ABC(x))
EACH(park, const iqfoc_dq_t x = iqfoc_park(AB(0), iq24_sincos(IN(2))); OUT_DQ(x))
EACH(park_inverse, const iqfoc_ab_t x = iqfoc_park_inverse(DQ(0), iq24_sincos(IN(2))); OUT_AB(x))

EACH(rotor, const iqfoc_rotor_t r = iqfoc_rotor_from_speed(IN(0)); OUT(0, r.speed); OUT(1, r.phi);
     OUT(2, r.s1); OUT(3, r.s2); OUT(4, r.phi_s1); OUT(5, r.phi_s2))
EACH(steady_gain, OUT(0, iqfoc_rotor_steady_gain(IN(0))))

EACH(mean_correct, const iqfoc_rotor_t r = iqfoc_rotor_from_speed(IN(5));
     const iqfoc_dq_t x = iqfoc_mean_current_correct(AB(0), AB(2), &r, iq24_sincos(IN(4))); OUT_DQ(x))
EACH(mean_correct_steady,
     const iqfoc_dq_t x = iqfoc_mean_current_correct_steady(AB(0), iqfoc_rotor_steady_gain(IN(3)),
                                                            iq24_sincos(IN(2)));
     OUT_DQ(x))

EACH(modulate, const iqfoc_duties_t x = iqfoc_modulate(AB(0), IN(2), IN(3)); OUT_ABC(x.high); OUT(3, x.scale))
EACH(modulate_nearest, const iqfoc_duties_t x = iqfoc_modulate_nearest(AB(0), IN(2)); OUT_ABC(x.high);
     OUT(3, x.scale))
EACH(modulated_voltage, const iqfoc_ab_t x = iqfoc_modulated_voltage(ABC(0), IN(3)); OUT_AB(x))
EACH(six_step_state, OUT(0, iqfoc_six_step_state(IN(0))))
EACH(six_step_voltage, const iqfoc_ab_t x = iqfoc_six_step_voltage(IN(0), IN(1)); OUT_AB(x))

static const py_function functions[] = {
    {"mul", 2, 1, each_mul},
    {"div", 2, 1, each_div},
    {"sqrt", 1, 1, each_sqrt},
    {"atan2", 2, 1, each_atan2},
    {"sincos", 1, 2, each_sincos},
    {"clarke2", 2, 2, each_clarke2},
    {"clarke3", 3, 2, each_clarke3},
    {"clarke_inverse", 2, 3, each_clarke_inverse},
    {"park", 3, 2, each_park},
    {"park_inverse", 3, 2, each_park_inverse},
    {"rotor", 1, 6, each_rotor},
    {"steady_gain", 1, 1, each_steady_gain},
    {"mean_correct", 6, 2, each_mean_correct},
    {"mean_correct_steady", 4, 2, each_mean_correct_steady},
    {"modulate", 4, 4, each_modulate},
    {"modulate_nearest", 3, 4, each_modulate_nearest},
    {"modulated_voltage", 4, 2, each_modulated_voltage},
    {"six_step_state", 1, 1, each_six_step_state},
    {"six_step_voltage", 2, 2, each_six_step_voltage},
};

const py_function *py_functions(size_t *count)
{
    *count = sizeof functions / sizeof functions[0];
    return functions;
}

void py_from_float(size_t n, const double *x, int32_t *iq)
{
    for (size_t k = 0; k < n; k++) {
        iq[k] = iq24_from_double(x[k]);
    }
}
