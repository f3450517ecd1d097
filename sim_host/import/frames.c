#include "frames.h"

#include "base/vector.h"
#include "data/speed_from_angle.h"

#include <string.h>

/* ---- angle and speed ---- */

static bool put_angle(const conversion *v)
{
    recording *r = v->r;
    const double *theta = v->c.value[QUANTITY_THETA];
    const double *omega = v->c.value[QUANTITY_OMEGA];
    r->theta_e_rad = conversion_column(v);
    r->omega_e_rad_s = conversion_column(v);
    if (v->e->status != STATUS_DONE) {
        return false;
    }
    for (size_t k = 0; k < r->rows; k++) {
        r->theta_e_rad[k] = theta != NULL ? theta[k] : v->map->theta_e_rad;
        r->omega_e_rad_s[k] = omega != NULL ? omega[k] : v->map->omega_e_rad_s;
    }
    if (omega == NULL && !v->map->has_fixed_omega && theta != NULL &&
        !speed_from_angle(r, v->t->path, v->e)) {
        return false;
    }
    if (theta != NULL && v->map->column[QUANTITY_THETA].mechanical &&
        v->c.value[QUANTITY_THETA_MECH] == NULL) {
        r->theta_mech_rad = conversion_column(v);
        for (size_t k = 0; r->theta_mech_rad != NULL && k < r->rows; k++) {
            r->theta_mech_rad[k] = theta[k] / (double)v->motor->pole_pairs;
        }
    }
    return v->e->status == STATUS_DONE;
}

/* ---- currents and voltages ---- */

/* Two of three phases make the third: the star point floats. */
static void complete(const double *in[3], double *out[3], size_t rows)
{
    for (int x = 0; x < 3; x++) {
        const int y = (x + 1) % 3;
        const int z = (x + 2) % 3;
        for (size_t k = 0; k < rows; k++) {
            out[x][k] = in[x] != NULL ? in[x][k] : -in[y][k] - in[z][k];
        }
    }
}

/* A vector in either frame as phases; `ahead` in cycles is by how much the angle leads theta_e. */
static void turn(const conversion *v, quantity first, bool is_dq, double *out[3])
{
    const recording *r = v->r;
    const double ahead = v->map->column[first].ahead * r->T_s;
    for (size_t k = 0; k < r->rows; k++) {
        const double x = v->c.value[first][k];
        const double y = v->c.value[(int)first + 1][k];
        vec_ab s = {x, y};
        if (is_dq) {
            s = vec_to_ab((vec_dq){x, y}, rotor_at(r->theta_e_rad[k] + ahead * r->omega_e_rad_s[k]));
        }
        double abc[3];
        vec_to_phases(s, abc);
        for (int phase = 0; phase < 3; phase++) {
            out[phase][k] = abc[phase];
        }
    }
}

static bool put_currents(const conversion *v)
{
    recording *r = v->r;
    if (!conversion_three(v, r->i_A)) {
        return false;
    }
    if (conversion_has(v, QUANTITY_I_A, 3) >= 2) {
        const double *in[3] = {v->c.value[QUANTITY_I_A], v->c.value[QUANTITY_I_B], v->c.value[QUANTITY_I_C]};
        complete(in, r->i_A, r->rows);
        r->i_c_measured = columns_have(&v->c, QUANTITY_I_A, 3);
    } else {
        const bool is_dq = columns_have(&v->c, QUANTITY_I_D, 2);
        turn(v, is_dq ? QUANTITY_I_D : QUANTITY_I_ALPHA, is_dq, r->i_A);
    }
    if (conversion_has(v, QUANTITY_MID_A, 3) >= 2) {
        const double *in[3] = {v->c.value[QUANTITY_MID_A], v->c.value[QUANTITY_MID_B],
                               v->c.value[QUANTITY_MID_C]};
        if (!conversion_three(v, r->i_mid_A)) {
            return false;
        }
        complete(in, r->i_mid_A, r->rows);
    }
    return true;
}

/* u_ab + u_bc + u_ca = 0: two of them make the third, and the star's voltages are a third of differences. */
static void from_lines(const conversion *v, double *u[3])
{
    const double *in[3] = {v->c.value[QUANTITY_U_AB], v->c.value[QUANTITY_U_BC], v->c.value[QUANTITY_U_CA]};
    complete(in, u, v->r->rows);
    for (size_t k = 0; k < v->r->rows; k++) {
        const double ab = u[0][k];
        const double bc = u[1][k];
        const double ca = u[2][k];
        u[0][k] = (ab - ca) / 3.0;
        u[1][k] = (bc - ab) / 3.0;
        u[2][k] = (ca - bc) / 3.0;
    }
}

static bool put_voltages(const conversion *v)
{
    recording *r = v->r;
    const bool lines = conversion_has(v, QUANTITY_U_AB, 3) >= 2;
    const bool phases = columns_have(&v->c, QUANTITY_U_A, 3);
    const bool dq = columns_have(&v->c, QUANTITY_U_D, 2);
    const bool ab = columns_have(&v->c, QUANTITY_U_ALPHA, 2);
    if ((phases || dq || ab || lines) && !conversion_three(v, r->u_V)) {
        return false;
    }
    if (phases) {
        for (size_t k = 0; k < r->rows; k++) {
            const double *const *u = (const double *const *)&v->c.value[QUANTITY_U_A];
            const double common = (u[0][k] + u[1][k] + u[2][k]) / 3.0;
            for (int x = 0; x < 3; x++) {
                r->u_V[x][k] = u[x][k] - common;
            }
        }
    } else if (dq || ab) {
        turn(v, dq ? QUANTITY_U_D : QUANTITY_U_ALPHA, dq, r->u_V);
    } else if (lines) {
        from_lines(v, r->u_V);
    }
    return true;
}

static bool put_link_and_duties(const conversion *v)
{
    recording *r = v->r;
    const double *link = v->c.value[QUANTITY_U_DC];
    if (link != NULL || v->map->has_fixed_u_dc) {
        r->u_dc_V = conversion_column(v);
        for (size_t k = 0; r->u_dc_V != NULL && k < r->rows; k++) {
            r->u_dc_V[k] = link != NULL ? link[k] : v->map->u_dc_V;
            if (r->u_dc_V[k] <= 0.0) {
                return error_input(v->e, v->t->path, v->t->line[k], 0, "u_dc_V is %g; expected a voltage > 0",
                                   r->u_dc_V[k]);
            }
        }
    }
    if (columns_have(&v->c, QUANTITY_D_A, 3) && r->u_dc_V != NULL) {
        if (!conversion_three(v, r->duty)) {
            return false;
        }
        for (int x = 0; x < 3; x++) {
            memcpy(r->duty[x], v->c.value[QUANTITY_D_A + x], r->rows * sizeof(double));
        }
    }
    return v->e->status == STATUS_DONE;
}

static bool put_rest(const conversion *v)
{
    static const quantity from[] = {QUANTITY_THETA_MECH, QUANTITY_TEMP};
    double **to[] = {&v->r->theta_mech_rad, &v->r->temp_C};
    for (size_t n = 0; n < sizeof from / sizeof *from; n++) {
        if (v->c.value[from[n]] != NULL) {
            *to[n] = conversion_column(v);
            if (*to[n] == NULL) {
                return false;
            }
            memcpy(*to[n], v->c.value[from[n]], v->r->rows * sizeof(double));
        }
    }
    return true;
}

bool frames_fill(const conversion *v)
{
    return put_angle(v) && put_currents(v) && put_voltages(v) && put_link_and_duties(v) && put_rest(v);
}
