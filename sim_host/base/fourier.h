/* The discrete Fourier transform, by KissFFT (fourier.cpp). */
#ifndef SIM_HOST_BASE_FOURIER_H
#define SIM_HOST_BASE_FOURIER_H

#include <math.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fourier_number {
    double re;
    double im;
} fourier_number;

/* Hann's window at row j of n. */
static inline double fourier_window(size_t j, size_t n)
{
    return 0.5 - 0.5 * cos(6.28318530717958647693 * ((double)j + 0.5) / (double)n);
}

/* The factors of one length, kept from one transform to the next of that length. NULL: out of memory. */
typedef struct fourier fourier;
fourier *fourier_new(void);

/* to[k] = the sum over j of from[j] e^(-2 pi i j k / n), for k = 0 to n - 1, n > 0; not in place. */
void fourier_forward(fourier *f, size_t n, const fourier_number *from, fourier_number *to);

/* NULL is allowed. */
void fourier_free(fourier *f);

#ifdef __cplusplus
}
#endif

#endif
