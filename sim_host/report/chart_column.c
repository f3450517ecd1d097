/* Numbers as base64 and as even pieces (chart_column.h). */
#include "chart_column.h"

#include "../base/base64.h"
#include "chart.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

static double number_of(const chart_column *c, size_t n)
{
    return c->at[n * c->stride];
}

/* Little-endian, whatever this machine is. */
static void put_bits(base64 *b, uint64_t bits, size_t bytes)
{
    unsigned char text[8];
    for (size_t n = 0; n < bytes; n++) {
        text[n] = (unsigned char)(bits >> (8 * n));
    }
    base64_add(b, text, bytes);
}

/* How many values from `from` on rise by `step`. */
static size_t even_from(const chart_column *c, size_t from, double step)
{
    const double first = number_of(c, from);
    size_t n = 1;
    while (from + n < c->count && fabs(number_of(c, from + n) - first - (double)n * step) < 0.01 * step) {
        n++;
    }
    return n;
}

/*
 * The longer of two pieces. Of time stamps with few decimals the first step alone is too coarse, and where many follow
 * their mean is right; before a gap it is not.
 */
static size_t piece_from(const chart_column *c, size_t from, double *step)
{
    enum { MANY = 64 };
    size_t most = 1;
    for (size_t far = MANY; far > 0; far = far > 1 ? 1 : 0) {
        if (from + far < c->count) {
            const double tried = (number_of(c, from + far) - number_of(c, from)) / (double)far;
            const size_t length = even_from(c, from, tried);
            *step = length > most ? tried : *step;
            most = length > most ? length : most;
        }
    }
    return most;
}

static size_t pieces_of(const chart_column *c, FILE *out)
{
    size_t pieces = 0;
    for (size_t from = 0; from < c->count; pieces++) {
        double step = 0.0;
        const size_t length = piece_from(c, from, &step);
        if (out != NULL) {
            fprintf(out, "%s[%.15g,%.15g,%zu]", pieces > 0 ? "," : "", number_of(c, from), step, length);
        }
        from += length;
    }
    return pieces;
}

void chart_column_x(FILE *out, const chart_column *c)
{
    if (c->count > 8 && pieces_of(c, NULL) < c->count / 8) {
        fputs("{\"pieces\":[", out);
        pieces_of(c, out);
        fputs("]}", out);
        return;
    }
    base64 b = {.out = out};
    fputs("{\"f8\":\"", out);
    for (size_t n = 0; n < c->count; n++) {
        const double x = number_of(c, n);
        uint64_t bits;
        memcpy(&bits, &x, sizeof bits);
        put_bits(&b, bits, sizeof bits);
    }
    base64_end(&b);
    fputs("\"}", out);
}

static void put_floats(FILE *out, const chart_column *c)
{
    base64 b = {.out = out};
    fputs("{\"f4\":\"", out);
    for (size_t n = 0; n < c->count; n++) {
        const double y = number_of(c, n);
        /* One NaN, whatever the machine's looks like. */
        const float x = isfinite(y) && fabs(y) < 3e38 ? (float)y : 0.0F;
        uint32_t bits = 0x7fc00000;
        if (isfinite(y)) {
            memcpy(&bits, &x, sizeof bits);
        }
        put_bits(&b, bits, sizeof bits);
    }
    base64_end(&b);
    fputs("\"}", out);
}

static void put_steps(FILE *out, const chart_column *c)
{
    enum { MOST = 32767, GAP = -32768 };
    double low = INFINITY;
    double high = -INFINITY;
    for (size_t n = 0; n < c->count; n++) {
        const double y = number_of(c, n);
        if (isfinite(y)) {
            low = fmin(low, y);
            high = fmax(high, y);
        }
    }
    const double middle = high >= low ? 0.5 * low + 0.5 * high : 0.0;
    const double step = high > low ? (0.5 * high - 0.5 * low) / MOST : 1.0;
    base64 b = {.out = out};
    fputs("{\"i2\":\"", out);
    for (size_t n = 0; n < c->count; n++) {
        const double y = number_of(c, n);
        const long steps = isfinite(y) ? lround(fmax(-MOST, fmin(MOST, (y - middle) / step))) : GAP;
        put_bits(&b, (uint64_t)steps, 2);
    }
    base64_end(&b);
    fprintf(out, "\",\"middle\":%.15g,\"step\":%.15g}", middle, step);
}

void chart_column_y(FILE *out, const chart_column *c)
{
    if (c->count > CHART_EXACT) {
        put_steps(out, c);
    } else {
        put_floats(out, c);
    }
}
