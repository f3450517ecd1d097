/* Rows that stand out (glitches.h). */
#include "glitches.h"

#include "base/normal.h"
#include "base/sort.h"
#include "diagnose/identify/observer.h"

#include <math.h>
#include <stdlib.h>

/* An innovation longer than this many (robust) standard deviations is an outlier; by chance once in 1e10 rows. */
static const double GLITCH = 7.0;
/* Glitches are isolated. If more rows lie between this many deviations and GLITCH than beyond GLITCH, the tail is a
 * model error (dead time near zero current), and no row is left out. */
static const double TAIL = 4.5;
/* More glitches than this share of the rows are no glitches, but a model that does not fit. */
static const double GLITCH_SHARE = 0.03;

size_t measure_glitches(fit_data *d, const fit_state *s)
{
    diagnose_rows *r = d->rows;
    averaged_drive drive = fit_drive(d, s);
    averaged_node *nodes = rows_nodes(r, &drive);
    double *square = calloc(r->rows + 1, sizeof *square);
    double *innovation = calloc(OBSERVER_OUTPUTS * r->rows + 1, sizeof *innovation);
    double *seen = calloc(r->rows + 1, sizeof *seen);
    unsigned char *before = calloc(r->rows + 1, sizeof *before); /* the outliers found before */
    size_t found = 0;
    size_t apart = 0;
    size_t between = 0;
    /* A compensation uses a sign that noise decides near zero current: such an outlier is no glitch. */
    const bool signs = hypothesis_in(s->set, H_COMPENSATED);
    if (!nodes || !square || !innovation || !seen || !before) {
        rows_note_no_memory(r);
    }
    for (size_t k = 0; before && k < r->rows; k++) {
        before[k] = r->outlier[k];
        apart += before[k];
    }
    for (size_t g = 0; !signs && nodes && square && innovation && seen && before && g < r->groups; g++) {
        size_t n = 0;
        for (size_t b = 0; b < r->blocks; b++) {
            if (r->block[b].group != g) {
                continue;
            }
            observer_block(r, &drive, nodes, &r->block[b], s->noise[g].gain, 0.0, innovation, seen);
            for (size_t j = 0; j < r->block[b].count; j++) {
                const double *e = innovation + OBSERVER_OUTPUTS * j;
                square[n] = e[0] * e[0] + e[1] * e[1];
                n += seen[j] > 0.0 ? 1 : 0;
            }
        }
        if (n < 20) {
            continue;
        }
        sort_ascending(square, n);
        double deviation = sqrt(square[n / 2] / NORMAL_MEDIAN_SQUARE);
        for (size_t k = 0; k < n; k++) {
            double size = sqrt(square[k]) / deviation;
            apart += size > GLITCH;
            between += size > TAIL && size <= GLITCH;
        }
        for (size_t b = 0; b < r->blocks; b++) {
            if (r->block[b].group == g) {
                observer_block(r, &drive, nodes, &r->block[b], s->noise[g].gain, GLITCH * deviation,
                               innovation, NULL);
            }
        }
    }
    for (size_t k = 0; k < r->rows; k++) {
        found += r->outlier[k];
    }
    if (before && ((double)found > GLITCH_SHARE * (double)r->rows || between > apart)) {
        found = 0;
        for (size_t k = 0; k < r->rows; k++) {
            r->outlier[k] = before[k];
            found += before[k];
        }
    }
    free(nodes);
    free(square);
    free(innovation);
    free(seen);
    free(before);
    return found;
}
