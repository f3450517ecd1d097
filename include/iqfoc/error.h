/*
 * Errors of all set-up functions: one enumeration for the whole library, so that a firmware stores one type and each
 * number has one meaning. 0: success. Negative: refused, and the object is unchanged.
 */
#ifndef IQFOC_ERROR_H
#define IQFOC_ERROR_H

typedef enum iqfoc_error {
    IQFOC_OK = 0,
    IQFOC_ERROR_NULL = -1, /* a pointer is NULL that must not be */
    /* iqfoc_cycle_init */
    IQFOC_ERROR_PREDICTOR = -2,     /* a coefficient outside the range stated in predictor.h */
    IQFOC_ERROR_GAINS = -3,         /* a gain outside the range stated in current_control.h */
    IQFOC_ERROR_SPAN = -4,          /* span_max not in (0, 1] */
    IQFOC_ERROR_CURRENT_LIMIT = -5, /* not in (0, 16] */
    IQFOC_ERROR_CHOICE = -6,        /* feedback, modulation or safe_state is not of its enumeration */
    IQFOC_ERROR_TIMES = -7,         /* period_ticks and tolerance_ticks together above 2^31 - 1 */
    /* iqfoc_cycle_init_by */
    IQFOC_ERROR_METHODS =
        -8, /* methods that cannot be combined, or a number for deadbeat control out of range */
    /* iqfoc_extension_check: a value outside the range stated in extension.h */
    IQFOC_ERROR_CURRENT_SENSOR = -10, /* i_offset or i_gain_inverse */
    IQFOC_ERROR_ANGLE = -11,          /* theta_0 or theta_delay */
    IQFOC_ERROR_VOLTAGE = -12,        /* k_u, v_dead or knee_inverse */
    IQFOC_ERROR_SATURATION = -13,
    /* iqfoc_flux_predictor_check: a value outside the range stated in flux_predictor.h */
    IQFOC_ERROR_INDUCTANCE_D = -20, /* l_d or k_d, or k_d is not 1/l_d */
    IQFOC_ERROR_INDUCTANCE_Q = -21, /* the same for q */
    IQFOC_ERROR_RESISTANCE = -22,
    IQFOC_ERROR_FLUX = -23, /* psi */
    /* iqfoc_flux_map_check; the four above there too */
    IQFOC_ERROR_FLUX_PART = -24, /* a part's e, k_d, k_q or x_0, or sums of the parts */
    /* iqfoc_reference_check; _CURRENT_LIMIT there too */
    IQFOC_ERROR_SALIENCY = -25,  /* |saliency i_max| beyond 11 */
    IQFOC_ERROR_WEAKENING = -26, /* gain or share */
    /* iqfoc_recorder_init */
    IQFOC_ERROR_CHANNELS = -30, /* their number, a source, a mantissa of 0 or a shift above 62 */
    IQFOC_ERROR_MEMORY = -31,   /* room for less than two rows */
    IQFOC_ERROR_PERIOD = -32,   /* period or decimation */
    IQFOC_ERROR_TRIGGER = -33,  /* no such trigger or channel, or a share outside [0, 1) */
    /* Drive services and sensors: a field outside the range stated in the header */
    IQFOC_ERROR_OFFSET_LIMITS = -40, /* offset.h */
    IQFOC_ERROR_START = -41,         /* start.h */
    IQFOC_ERROR_TRACKER = -42,       /* tracker.h */
    IQFOC_ERROR_ENCODER = -43,       /* encoder.h */
    IQFOC_ERROR_RESOLVER = -44,      /* resolver.h */
    IQFOC_ERROR_HALLS = -45,         /* halls.h */
    IQFOC_ERROR_SHUNTS = -46,        /* shunts.h */
    IQFOC_ERROR_RESTART = -47,       /* restart.h */
    IQFOC_ERROR_SUPERVISION = -48,   /* supervision.h */
    IQFOC_ERROR_OBSERVER = -49,      /* observer.h */
    IQFOC_ERROR_PATTERN = -50,       /* pattern.h: the table or the least time */
    IQFOC_ERROR_SPEED_CONTROL = -51, /* speed_control.h */
    IQFOC_ERROR_CARRIER = -52,       /* synchronous_carrier.h */
    IQFOC_ERROR_WATCH_ANGLE = -53,   /* watch_angle.h */
    IQFOC_ERROR_PULSE_MODE = -54,    /* pulse_mode.h */
    IQFOC_ERROR_COMMISSION = -55     /* commission.h */
} iqfoc_error_t;

#endif
