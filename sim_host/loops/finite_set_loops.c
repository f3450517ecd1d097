/* The study of finite-control-set control (finite_set_loops.h). */
#include "finite_set_loops.h"

#include "base/progress.h"

#include <math.h>

const double finite_set_ratios[FINITE_SET_RATIOS] = {10.15, 20.15, 30.15, 50.15, 100.15};
const double finite_set_weights[FINITE_SET_WEIGHTS] = {0.0, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2};

bool finite_set_loop_run(double ratio, iqfoc_model_t model, int horizon, double weight,
                         finite_set_point *point, error *e)
{
    finite_set_drive drive;
    const loop_case c = current_loop_case(ratio, 0.0);
    if (!finite_set_drive_init(&drive, &c.truth, model, e)) {
        return false;
    }
    drive.horizon = horizon;
    drive.weight = iq24_from_double(weight);
    const drive_firmware firmware = finite_set_drive_firmware(&drive);
    if (!closed_loop_run(&c, &firmware, &point->loop, e)) {
        return false;
    }
    point->nodes = (double)drive.nodes / (double)drive.decisions;
    return true;
}

static bool run_trade(finite_set_loops *all, int w, error *e)
{
    for (int h = 0; h < IQFOC_FINITE_SET_HORIZON; h++) {
        if (!finite_set_loop_run(FINITE_SET_TRADE_RATIO, IQFOC_MODEL_EXACT, h + 1, finite_set_weights[w],
                                 &all->trade[h][w], e)) {
            return false;
        }
    }
    const double fundamental_Hz = loop_motor_at(1.0).f_pwm_Hz;
    const double ratio = round(all->trade[0][w].loop.switching_Hz / fundamental_Hz);
    all->pwm_ratio[w] = ratio >= 5.0 ? ratio : 0.0;
    return all->pwm_ratio[w] <= 0.0 ||
           current_loop_run(ratio, LOOP_DEADBEAT_EXACT, &loop_beliefs[LOOP_NOMINAL], 0.0, &all->pwm[w], e);
}

bool finite_set_loops_run(finite_set_loops *all, error *e)
{
    progress shown = progress_begin("loops", FINITE_SET_RATIOS + FINITE_SET_WEIGHTS, "finite sets");
    bool ok = true;
    for (int k = 0; k < FINITE_SET_RATIOS && ok; k++) {
        for (int p = 0; p < FINITE_SET_PREDICTORS && ok; p++) {
            for (int h = 0; h < IQFOC_FINITE_SET_HORIZON && ok; h++) {
                ok = finite_set_loop_run(finite_set_ratios[k], loop_models[p], h + 1, 0.0, &all->at[k][p][h],
                                         e);
            }
        }
        progress_update(&shown, k + 1.0);
    }
    for (int w = 0; w < FINITE_SET_WEIGHTS && ok; w++) {
        ok = run_trade(all, w, e);
        progress_update(&shown, FINITE_SET_RATIOS + w + 1.0);
    }
    progress_end(&shown);
    return ok;
}
