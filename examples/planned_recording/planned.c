/* A planned recording's references (planned.h). */
#include "planned.h"

bool planned_over(const planned_t *p)
{
    return p->run >= p->count;
}

bool planned_logs(const planned_t *p)
{
    return !planned_over(p) && p->cycle >= p->runs[p->run].settle_cycles;
}

/* k: logged cycles so far; below 0 while the drive settles. Rounded to nearest once. */
static iq24_t course_at(const planned_course_t *c, int32_t k)
{
    const int32_t gone = k < 0 ? 0 : k < c->ramp_cycles ? k : c->ramp_cycles;
    const int64_t line = c->from_q48 + c->per_cycle_q48 * gone;
    const bool squares = k >= 0 && c->half_cycles > 0;
    const int64_t square = squares ? (k / c->half_cycles % 2 == 0 ? c->square_q48 : -c->square_q48) : 0;
    return (iq24_t)iq24_asr64(line + square + (INT64_C(1) << 23), IQ24_FRACTION_BITS);
}

iqfoc_dq_t planned_reference(const planned_t *p)
{
    iqfoc_dq_t reference = {0, 0};
    if (!planned_over(p)) {
        const planned_run_t *run = &p->runs[p->run];
        const int32_t k = p->cycle - run->settle_cycles;
        reference.d = course_at(&run->d, k);
        reference.q = course_at(&run->q, k);
    }
    return reference;
}

iq24_t planned_speed(const planned_t *p)
{
    if (planned_over(p)) {
        return 0;
    }
    const planned_run_t *run = &p->runs[p->run];
    const int32_t k = p->cycle < run->settle_cycles ? 0 : p->cycle - run->settle_cycles;
    return run->speed_begin + (iq24_t)((int64_t)(run->speed_end - run->speed_begin) * k / run->cycles);
}

void planned_next(planned_t *p)
{
    if (planned_over(p)) {
        return;
    }
    p->cycle++;
    if (p->cycle >= p->runs[p->run].settle_cycles + p->runs[p->run].cycles) {
        p->cycle = 0;
        p->run++;
    }
}
