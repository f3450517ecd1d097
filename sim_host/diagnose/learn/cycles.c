/* One-cycle errors turned into voltages seen from the rotor (cycles.h). */
#include "cycles.h"

#include "diagnose/identify/observer.h"

static vec_rotor turned(double cos_at, double sin_at, double by_rad)
{
    const vec_rotor by = rotor_at(by_rad);
    return (vec_rotor){cos_at * by.cos - sin_at * by.sin, sin_at * by.cos + cos_at * by.sin};
}

size_t cycles_of(const learn_model *m, const row_block *block, vec_ab *wrong, learn_left *out)
{
    const diagnose_rows *r = m->rows;
    /* From one row ahead: the current that a cycle starts with is what the row before predicts. That row's own noise
     * is in the cycle's error, and a term of the current would learn it. */
    const size_t first = block->first - 1;
    observer_one_cycle(r, m->drive, m->nodes, first, block->count + 1, wrong);
    for (size_t j = 1; j < block->count; j++) {
        const size_t k = first + j;
        const cycle_row *row = &r->row[k];
        const vec_ab start = {row->i_A.alpha - wrong[j].alpha, row->i_A.beta - wrong[j].beta};
        const double half = 0.5 * row->omega_rad_s * r->T_s;
        learn_left *left = &out[j - 1];
        const vec_rotor middle = turned(row->cos_theta, row->sin_theta, half);
        *left =
            (learn_left){.cycle = {.middle = middle,
                                   .mechanical = turned(row->cos_mech, row->sin_mech, half / m->pole_pairs),
                                   .mech_known = r->mech_known,
                                   .half_turn_rad = half,
                                   .omega_rad_s = row->omega_rad_s,
                                   .i_A = vec_to_dq(start, (vec_rotor){row->cos_theta, row->sin_theta}),
                                   .u_V = vec_to_dq(row->u_V[0], middle),
                                   .u_before_V = vec_to_dq(row->u_V[1], middle),
                                   .elapsed_s = row->elapsed_s,
                                   .temperature_K = row->temperature_K},
                         .wrong_A = wrong[j + 1],
                         .end = {row[1].cos_theta, row[1].sin_theta},
                         .glitch = r->outlier[k - 1] || r->outlier[k] || r->outlier[k + 1]};
        const vec_dq at_end = vec_to_dq(left->wrong_A, left->end);
        const vec_dq v = {m->drive->L_d_H / r->T_s * at_end.d, m->drive->L_q_H / r->T_s * at_end.q};
        left->v_V = vec_to_dq(vec_to_ab(v, left->end), middle);
    }
    return block->count - 1;
}

vec_ab cycles_error(const learn_model *m, const learn_left *left, vec_dq v_V)
{
    const double T_s = m->rows->T_s;
    const vec_dq at_end = vec_to_dq(vec_to_ab(v_V, left->cycle.middle), left->end);
    const vec_dq i = {T_s / m->drive->L_d_H * at_end.d, T_s / m->drive->L_q_H * at_end.q};
    return vec_to_ab(i, left->end);
}
