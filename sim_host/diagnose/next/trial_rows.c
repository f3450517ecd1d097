/* Windows of pieces as a recording of the averaged model (trial_rows.h). */
#include "trial_rows.h"

#include <math.h>
#include <stdlib.h>

typedef enum trial_column {
    OF_TIME,
    OF_RUN,
    OF_I_A,
    OF_I_B,
    OF_U_A,
    OF_U_B,
    OF_U_C,
    OF_U_DC,
    OF_THETA,
    OF_OMEGA,
    OF_THETA_MECH,
    TRIAL_COLUMNS
} trial_column;

static const char *const column_name[TRIAL_COLUMNS] = {
    "t_s",   "run",    "i_a_A",       "i_b_A",         "u_a_V",         "u_b_V",
    "u_c_V", "u_dc_V", "theta_e_rad", "omega_e_rad_s", "theta_mech_rad"};

/* A current control's reach: the share of an error that a cycle corrects. */
static const double FOLLOWS = 0.25;
/* Of the link's largest vector. */
static const double VOLTAGE_SHARE = 0.95;
/* A window's electrical angle ahead of the last one's: they never meet again. */
static const double GOLDEN_ANGLE_RAD = 2.399963;

/* What runs: the machine alone. What a sensor or the inverter does wrong tells nothing of where the current goes. */
typedef struct runner {
    averaged_drive drive;
    averaged_node node;
    double u_most_V;
    double T_s;
    int pole_pairs;
    size_t row, windows;
    double *of[TRIAL_COLUMNS];
} runner;

static averaged_drive machine_of(const averaged_drive *found, const averaged_drive *nominal)
{
    averaged_drive d = {.R_ohm = found->R_ohm,
                        .L_d_H = found->L_d_H,
                        .L_q_H = found->L_q_H,
                        .psi_f_Wb = found->psi_f_Wb,
                        .saturation = found->saturation,
                        .w_ddd = found->w_ddd,
                        .w_dqq = found->w_dqq,
                        .w_dddd = found->w_dddd,
                        .w_ddqq = found->w_ddqq,
                        .w_qqqq = found->w_qqqq,
                        .iron = {found->iron[0], found->iron[1]},
                        .i_knee_A = nominal->i_knee_A,
                        .k_u = 1.0,
                        .g = {1.0, 1.0, 1.0}};
    return d;
}

static bool turns(const plan_piece *p)
{
    return p->rpm[0] != 0.0 || p->rpm[1] != 0.0;
}

/* One where nothing but the squares moves, two angles of a rotor that turns, and more of what runs through levels. */
static size_t windows_of(const plan_piece *p)
{
    const bool ramps = p->rpm[0] != p->rpm[1] || p->i_d_A[0] != p->i_d_A[1] || p->i_q_A[0] != p->i_q_A[1];
    return ramps ? TRIAL_WINDOWS_MOST : turns(p) ? 2 : 1;
}

static double between(const double ends[2], double share)
{
    return ends[0] + share * (ends[1] - ends[0]);
}

static double square_at(double amplitude, int half_cycles, size_t cycle)
{
    if (amplitude == 0.0) {
        return 0.0;
    }
    return (cycle / (size_t)half_cycles) % 2 == 0 ? amplitude : -amplitude;
}

static vec_dq reference_at(const plan_piece *p, double share, size_t cycle)
{
    return (vec_dq){between(p->i_d_A, share) + square_at(p->square_d_A, p->half_d_cycles, cycle),
                    between(p->i_q_A, share) + square_at(p->square_q_A, p->half_q_cycles, cycle)};
}

/* The voltage that takes the current towards its reference within the cycle, as far as the link allows. */
static vec_ab command(const runner *t, cycle_row *row, vec_ab i, vec_dq wanted)
{
    const vec_rotor begin = {row->cos_theta, row->sin_theta};
    const vec_rotor end = {begin.cos * row->cos_turn - begin.sin * row->sin_turn,
                           begin.sin * row->cos_turn + begin.cos * row->sin_turn};
    const double(*by)[2] = t->node.value.drive; /* flux at the end, by the voltage at the beginning */
    row->u_V[0] = (vec_ab){0.0, 0.0};
    const vec_dq now = vec_to_dq(i, begin);
    const vec_dq left = vec_to_dq(averaged_drive_advance(&t->drive, &t->node, row, i, NULL), end);
    const vec_dq flux = {t->drive.L_d_H * (now.d + FOLLOWS * (wanted.d - now.d) - left.d),
                         t->drive.L_q_H * (now.q + FOLLOWS * (wanted.q - now.q) - left.q)};
    const double det = by[0][0] * by[1][1] - by[0][1] * by[1][0];
    vec_dq u = {(by[1][1] * flux.d - by[0][1] * flux.q) / det, (by[0][0] * flux.q - by[1][0] * flux.d) / det};
    const double share = fmin(1.0, t->u_most_V / fmax(hypot(u.d, u.q), 1e-300));
    return vec_to_ab((vec_dq){share * u.d, share * u.q}, begin);
}

static void write_row(runner *t, const cycle_row *row, double theta, double u_dc_V)
{
    double i[3];
    double u[3];
    const size_t k = t->row++;
    vec_to_phases(row->i_A, i);
    vec_to_phases(row->u_V[0], u);
    const double value[TRIAL_COLUMNS] = {[OF_TIME] = (double)k * t->T_s,
                                         [OF_RUN] = (double)t->windows,
                                         [OF_I_A] = i[0],
                                         [OF_I_B] = i[1],
                                         [OF_U_A] = u[0],
                                         [OF_U_B] = u[1],
                                         [OF_U_C] = u[2],
                                         [OF_U_DC] = u_dc_V,
                                         [OF_THETA] = theta,
                                         [OF_OMEGA] = row->omega_rad_s,
                                         [OF_THETA_MECH] = theta / t->pole_pairs};
    for (int c = 0; c < TRIAL_COLUMNS; c++) {
        t->of[c][k] = value[c];
    }
}

/* One window, at a share of the piece's course, at a constant speed. */
static void run_window(runner *t, const plan_piece *p, double share, double omega_rad_s, double u_dc_V)
{
    const size_t first = t->windows * TRIAL_WINDOW; /* the squares go on */
    const double turn = omega_rad_s * t->T_s;
    double theta = p->theta_e_rad + (omega_rad_s != 0.0 ? GOLDEN_ANGLE_RAD * (double)t->windows : 0.0);
    cycle_row row = {.omega_rad_s = omega_rad_s,
                     .cos_turn = cos(turn),
                     .sin_turn = sin(turn),
                     .u_dc_V = u_dc_V,
                     .T_s = t->T_s};
    row.i_A = vec_to_ab(reference_at(p, share, first), rotor_at(theta));
    t->node = averaged_node_at(t->drive.R_ohm, t->drive.L_d_H, t->drive.L_q_H, t->T_s, omega_rad_s);
    for (size_t j = 0; j < TRIAL_WINDOW; j++) {
        row.cos_theta = cos(theta);
        row.sin_theta = sin(theta);
        row.u_V[0] = command(t, &row, row.i_A, reference_at(p, share, first + j));
        write_row(t, &row, theta, u_dc_V);
        row.i_A = averaged_drive_advance(&t->drive, &t->node, &row, row.i_A, NULL);
        theta += turn;
    }
    t->windows++;
}

bool trial_rows_make(trial_rows *out, const session *w, const plan_piece *piece, size_t pieces, double u_dc_V)
{
    const averaged_drive found = session_drive(w, w->state.z);
    runner t = {.drive = machine_of(&found, &w->frame.nominal),
                .u_most_V = VOLTAGE_SHARE * u_dc_V / sqrt(3.0),
                .T_s = w->rows.T_s,
                .pole_pairs = w->frame.pole_pairs};
    size_t rows = 0;
    for (size_t n = 0; n < pieces; n++) {
        rows += windows_of(&piece[n]) * TRIAL_WINDOW;
    }
    double *all = calloc(rows * TRIAL_COLUMNS, sizeof *all);
    if (all == NULL) {
        return false;
    }
    for (int c = 0; c < TRIAL_COLUMNS; c++) {
        t.of[c] = all + (size_t)c * rows;
    }
    for (size_t n = 0; n < pieces; n++) {
        const size_t windows = windows_of(&piece[n]);
        for (size_t k = 0; k < windows; k++) {
            const double share = ((double)k + 0.5) / (double)windows;
            out->piece[t.windows] = n;
            run_window(&t, &piece[n], share, motor_speed_rad_s(w->frame.motor, between(piece[n].rpm, share)),
                       u_dc_V);
        }
    }
    error unused = {0};
    const bool ok = recording_make(&out->recording, "the next experiment", rows, TRIAL_COLUMNS, column_name,
                                   (const double *const *)t.of, &unused);
    free(all);
    return ok;
}
