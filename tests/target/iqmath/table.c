/*
 * The tables of docs/from-iqmath.md, which tools/figures.py puts there. `iqmath_table arithmetic`: IQmath by
 * its documents against iqfoc. `iqmath_table functions`: the error of iqfoc's functions against the exact
 * ones; TI documents none in LSB.
 */
#include "compare.h"

#include "iqfoc/iq24_math.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define DRAWS      1000000
#define TAU        6.283185307179586
#define ONE_DOUBLE 16777216.0

/* The upper half of a congruence modulo 2^64, of all magnitudes. */
static int32_t drawn(void)
{
    static uint64_t x = 0x9E3779B97F4A7C15;
    x = x * 6364136223846793005u + 20190401;
    return iq24_asr32(iq24_from_bits((uint32_t)(x >> 32)), (uint32_t)(x >> 27 & 15));
}

/* Of row k, in LSB; NAN: not an argument that is compared. */
static double error(int k, int32_t a, int32_t b)
{
    const iq24_sincos_t sc = iq24_sincos(a);
    switch (k) {
    case 0:
        return sc.sin - sin(TAU * (a / ONE_DOUBLE)) * ONE_DOUBLE;
    case 1:
        return sc.cos - cos(TAU * (a / ONE_DOUBLE)) * ONE_DOUBLE;
    case 2:
        return remainder(iq24_atan2(a, b) - atan2(a, b) / TAU * ONE_DOUBLE, ONE_DOUBLE);
    case 3:
        return a < 0 ? NAN : iq24_sqrt(a) - sqrt(a / ONE_DOUBLE) * ONE_DOUBLE;
    default:
        return b == 0 || fabs((double)a / b) >= 127.0 ? NAN : iq24_div(a, b) - (double)a / b * ONE_DOUBLE;
    }
}

static void functions(void)
{
    static const char *const rows[5][3] = {
        {"`_IQ24sinPU(x)`", "`iq24_sincos(x).sin`", "turns in both"},
        {"`_IQ24cosPU(x)`", "`iq24_sincos(x).cos`", "one call gives both"},
        {"`_IQ24atan2PU(y, x)`", "`iq24_atan2(y, x)`",
         "iqfoc: -0.5 to 0.5; `iqfoc_to_angle_pu` gives 0 to 1"},
        {"`_IQ24sqrt(x)`", "`iq24_sqrt(x)`", "0 for x below 0"},
        {"`_IQ24div(a, b)`", "`iq24_div(a, b)`", "saturates; a / 0 has the sign of a"},
    };
    (void)printf("| IQmath | iqfoc | iqfoc's largest error, LSB | |\n| --- | --- | ---: | --- |\n");
    for (int k = 0; k < 5; k++) {
        double largest = 0.0;
        for (int i = 0; i < DRAWS; i++) {
            const int32_t a = drawn();
            largest = fmax(largest, fabs(error(k, a, drawn()))); /* fmax leaves a NAN out */
        }
        (void)printf("| %s | %s | %.2f | %s |\n", rows[k][0], rows[k][1], largest, rows[k][2]);
    }
}

static void arithmetic(void)
{
    iqmath_row_t rows[IQMATH_ROWS];
    iqmath_compare(rows, DRAWS);
    (void)printf("| IQmath | iqfoc | largest difference, LSB | |\n| --- | --- | ---: | --- |\n");
    for (int k = 0; k < IQMATH_ROWS; k++) {
        (void)printf("| %s | %s | %ld | %s |\n", rows[k].ti, rows[k].ours, (long)rows[k].largest,
                     rows[k].why);
    }
}

int main(int count, char **words)
{
    if (count == 2 && strcmp(words[1], "arithmetic") == 0) {
        arithmetic();
    } else if (count == 2 && strcmp(words[1], "functions") == 0) {
        functions();
    } else {
        (void)fprintf(stderr, "iqmath_table: expected `arithmetic` or `functions`\n");
        return 2;
    }
    return 0;
}
