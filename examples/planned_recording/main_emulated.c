/*
 * A planned recording by the firmware of an emulated board: the references are its own, from iqfoc_plan.h; what the
 * simulator asks for is not looked at.
 *
 *     iqfoc simulate --motor M.toml --scenario plan.toml --target cortex-m4 --image planned_recording.elf -o rec.csv
 */
#include "iqfoc_plan.h"
#include "pil_reference.h"

static const planned_run_t runs[IQFOC_PLAN_RUNS] = IQFOC_PLAN;
static planned_t planned = {runs, IQFOC_PLAN_RUNS, 0, 0};

iqfoc_dq_t pil_reference(iqfoc_dq_t asked)
{
    (void)asked;
    const iqfoc_dq_t reference = planned_reference(&planned);
    planned_next(&planned);
    return reference;
}
