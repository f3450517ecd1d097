/*
 * A planned recording on the target: the references of the scenario that `iqfoc plan` wrote, cycle by cycle, from the header that it wrote with the plan (--firmware). They are those of `iqfoc simulate` to the last bit, so that the
 * recording of a bench and the simulated one can be laid side by side.
 *
 *     #include "iqfoc_plan.h"
 *     static planned_t planned;                              zeroed: at the first run's first settling cycle
 *     cycle.i_ref = planned_reference(&planned);             once a control cycle
 *     recorder: only while planned_logs(&planned); a run's first logged row begins a stretch of its own
 *     planned_next(&planned);                                the cycle has passed
 *
 * The bench holds planned_speed, or at standstill locks the rotor at the run's theta.
 */
#ifndef EXAMPLES_PLANNED_H
#define EXAMPLES_PLANNED_H

#include "iqfoc/iq24.h"
#include "iqfoc/vector.h"

#include <stdbool.h>
#include <stdint.h>

/* A current over a run's logged cycles: a straight line, then level, and a square on top. Per unit in Q48. */
typedef struct planned_course {
    int64_t from_q48;
    int64_t per_cycle_q48;
    int64_t square_q48;  /* up first */
    int32_t ramp_cycles; /* of the line */
    int32_t half_cycles; /* of the square; 0: none */
} planned_course_t;

typedef struct planned_run {
    int32_t settle_cycles; /* at the first values, not logged */
    int32_t cycles;
    iq24_t speed_begin; /* electrical speed, turns per cycle; changes evenly */
    iq24_t speed_end;
    iq24_t theta; /* electrical, of a locked rotor; turns */
    planned_course_t d, q;
} planned_run_t;

typedef struct planned {
    const planned_run_t *runs;
    int32_t count;
    int32_t run;   /* `count`: it is over */
    int32_t cycle; /* of the run, settling included */
} planned_t;

bool planned_over(const planned_t *p);

/* The cycle that comes is one of those to record. */
bool planned_logs(const planned_t *p);

/* Of the next cycle, per unit; 0 after the end. */
iqfoc_dq_t planned_reference(const planned_t *p);
iq24_t planned_speed(const planned_t *p);

void planned_next(planned_t *p);

#endif
