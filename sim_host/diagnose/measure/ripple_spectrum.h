/*
 * The spectra of the pieces in which a ripple is looked for: on one grid of frequencies, each with the noise around.
 */
#ifndef SIM_HOST_DIAGNOSE_MEASURE_RIPPLE_SPECTRUM_H
#define SIM_HOST_DIAGNOSE_MEASURE_RIPPLE_SPECTRUM_H

#include "ripple_line.h"

/* One piece's transform of a series under a Hann window, and the noise of the series along by frequency. */
typedef struct ripple_spectrum {
    double *
        power; /* of the series along; less than 0 where the frequency is an order of the piece's speed, or too low */
    double *beside; /* of the series across */
    double *noise;
    double gain; /* a share's line has the power (share gain)^2 */
} ripple_spectrum;

typedef struct ripple_spectra {
    const ripple_pieces *all;
    double T_s;
    size_t length;       /* of the padded transform */
    size_t bins;         /* the lowest of them that are searched */
    ripple_spectrum *of; /* one a piece */
} ripple_spectra;

/* False: out of memory; what was allocated is freed by the other either way. */
bool ripple_spectra_make(ripple_spectra *s, const ripple_pieces *all, double T_s);
void ripple_spectra_free(ripple_spectra *s);

double ripple_frequency_Hz(const ripple_spectra *s, double bin);

#endif
