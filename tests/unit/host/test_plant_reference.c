#include "test_plant_reference.h"

#include <cvode/cvode.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <stdio.h>
#include <stdlib.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#define TOLERANCE       1e-12
#define TOLERANCE_STIFF 1e-9 /* the knee is an approximation anyway */
#define STATES          12

static const double axis[3] = {0.0, 2.0943951023931954923, 4.1887902047863909846};

typedef struct opened {
    SUNContext context;
    N_Vector y, absolute;
    void *cvode;
    SUNNonlinearSolver fixed_point; /* Adams */
    SUNMatrix matrix;               /* BDF */
    SUNLinearSolver linear;
} opened;

static void must(bool good, const char *what)
{
    if (!good) {
        fprintf(stderr, "reference: %s failed\n", what);
        abort();
    }
}

/* The times-th derivative of x^n. */
static double slope(double x, int n, int times)
{
    double factor = 1.0;
    for (int k = 0; k < times; k++) {
        factor *= n - k;
    }
    return factor == 0.0 ? 0.0 : factor * pow(x, n - times);
}

/* Torque is the rate of co-energy with the mechanical angle at fixed currents. */
static int rates(double t, N_Vector vy, N_Vector vdy, void *user)
{
    const reference *r = user;
    const double clock = r->t + t; /* t restarts in each span */
    const double faded = r->heating != 0.0 ? exp(-clock / r->heating_s) : 1.0;
    const double above = r->heating * (1.0 - faded) - r->reference;
    const double psi = r->psi * (1.0 + r->alpha_psi * above) + r->psi_rate * clock;
    const double psi_rate =
        r->psi_rate + (r->heating != 0.0 ? r->psi * r->alpha_psi * r->heating / r->heating_s * faded : 0.0);
    const double *y = N_VGetArrayPointer(vy);
    double *dy = N_VGetArrayPointer(vdy);
    const double i_phase[3] = {y[0], y[1], -y[0] - y[1]};
    const double i_fe[3] = {y[8], y[9], -y[8] - y[9]};
    const double i[3] = {y[0] - y[8], y[1] - y[9], -y[0] - y[1] + y[8] + y[9]}; /* what magnetises */
    const double theta = y[2], omega = y[3];
    const double mean = 0.5 * (r->L_d + r->L_q), half = 0.5 * (r->L_d - r->L_q);

    double L_i[3] = {0}, dL_i[3] = {0}, turned[3], L[3][3], torque_per_pole_pair = 0.0, flux_rate[3],
           against[3];
    double square = 0.0, dsquare = 0.0; /* the current's, by the unsaturated energy; its rate by the angle */
    for (int x = 0; x < 3; x++) {
        for (int k = 0; k < 3; k++) {
            const double of_both = 2.0 * theta - axis[x] - axis[k];
            L[x][k] = 2.0 / 3.0 * (mean * cos(axis[x] - axis[k]) + half * cos(of_both));
            L_i[x] += L[x][k] * i[k];
            dL_i[x] += 2.0 / 3.0 * half * -2.0 * sin(of_both) * i[k];
        }
        square += 2.0 / 3.0 / mean * i[x] * L_i[x];
        dsquare += 2.0 / 3.0 / mean * i[x] * dL_i[x];
    }
    double f = 1.0, df_dsquare = 0.0;
    if (r->I_sat > 0.0) {
        f = 1.0 / (1.0 + square / (r->I_sat * r->I_sat));
        df_dsquare = -f * f / (r->I_sat * r->I_sat);
    }
    for (int x = 0; x < 3; x++) {
        const double from = theta - axis[x];
        const double dmagnet = -psi * sin(from) - 5.0 * r->psi_5 * sin(5.0 * from) -
                               7.0 * r->psi_7 * sin(7.0 * from) - 11.0 * r->psi_11 * sin(11.0 * from) -
                               13.0 * r->psi_13 * sin(13.0 * from);
        turned[x] = f * dL_i[x] + df_dsquare * dsquare * L_i[x] + dmagnet;
        torque_per_pole_pair += i[x] * (0.5 * f * dL_i[x] + dmagnet);
    }
    /* The map's derivatives by d and q, and those of d and q by a current, -2/3 sin and 2/3 cos, and by the angle. */
    double d = 0.0, q = 0.0, W_d = 0.0, W_q = 0.0, W_dd = 0.0, W_dq = 0.0, W_qq = 0.0;
    for (int x = 0; x < 3; x++) {
        d += 2.0 / 3.0 * i[x] * cos(theta - axis[x]);
        q -= 2.0 / 3.0 * i[x] * sin(theta - axis[x]);
    }
    for (int n = 0; n < 5; n++) {
        for (int k = 0; k < 5; k++) {
            const double w = r->w[n][k];
            if (w != 0.0) {
                W_d += w * slope(d, n, 1) * slope(q, k, 0);
                W_q += w * slope(d, n, 0) * slope(q, k, 1);
                W_dd += w * slope(d, n, 2) * slope(q, k, 0);
                W_dq += w * slope(d, n, 1) * slope(q, k, 1);
                W_qq += w * slope(d, n, 0) * slope(q, k, 2);
            }
        }
    }
    for (int x = 0; x < 3; x++) {
        const double c = cos(theta - axis[x]), s = sin(theta - axis[x]);
        turned[x] += (W_dd * q - W_dq * d - W_q) * c - (W_dq * q - W_qq * d + W_d) * s;
    }
    torque_per_pole_pair += 1.5 * (W_d * q - W_q * d);
    /* d(flux_x)/dt = sum_k D[x][k] di_k/dt + turned_x omega; with di_c = -di_a - di_b, two line-to-line
     * equations. */
    double D[3][3];
    double without[3]; /* the voltage left for flux and what lies in series with it */
    for (int x = 0; x < 3; x++) {
        for (int k = 0; k < 3; k++) {
            D[x][k] = f * L[x][k] + L_i[x] * df_dsquare * 4.0 / 3.0 / mean * L_i[k];
            const double c = cos(theta - axis[x]), s = sin(theta - axis[x]);
            const double c_k = cos(theta - axis[k]), s_k = sin(theta - axis[k]);
            D[x][k] += 2.0 / 3.0 * (W_dd * c * c_k - W_dq * (c * s_k + s * c_k) + W_qq * s * s_k);
        }
        double u = r->u_leg[x];
        if (r->knee > 0.0) {
            u = 0.5 * (r->least[x] + r->most[x]) -
                0.5 * (r->most[x] - r->least[x]) * tanh(i_phase[x] / r->knee);
        }
        without[x] = u - (r->R[x] + r->R_first * r->alpha_R * above + r->R_rate * clock) * i_phase[x];
    }
    double m[2][2], rhs[2];
    for (int k = 0; k < 2; k++) {
        for (int column = 0; column < 2; column++) {
            m[k][column] = D[k][column] - D[k][2] - D[k + 1][column] + D[k + 1][2];
        }
    }
    const double det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    /* An inductance in series takes its share of the voltage by the current's rate, which that voltage makes:
     * repeated until it converges. */
    const bool series = r->dL[0] != 0.0 || r->dL[1] != 0.0 || r->dL[2] != 0.0;
    dy[0] = dy[1] = 0.0;
    for (int again = 0; again < (series ? 60 : 1); again++) {
        const double rate[3] = {dy[0], dy[1], -dy[0] - dy[1]};
        for (int x = 0; x < 3; x++) {
            flux_rate[x] = without[x] - r->dL[x] * rate[x];
            against[x] = flux_rate[x] - turned[x] * omega - psi_rate * cos(theta - axis[x]);
        }
        for (int k = 0; k < 2; k++) {
            rhs[k] = against[k] - against[k + 1];
        }
        dy[0] = (m[1][1] * rhs[0] - m[0][1] * rhs[1]) / det;
        dy[1] = (m[0][0] * rhs[1] - m[1][0] * rhs[0]) / det;
        /* The star point floats: of the phase voltages only what differs counts. */
        const double common = (flux_rate[0] + flux_rate[1] + flux_rate[2]) / 3.0;
        for (int x = 0; x < 2; x++) {
            dy[8 + x] =
                r->R_fe > 0.0 ? (flux_rate[x] - common - r->R_fe * i_fe[x]) / (r->tau_fe * r->R_fe) : 0.0;
            dy[x] += dy[8 + x];
        }
    }
    dy[2] = omega;
    dy[3] = r->accel;
    if (r->J > 0.0) {
        const double torque = r->pole_pairs * torque_per_pole_pair;
        dy[3] = r->pole_pairs / r->J * (torque - r->T_load - r->friction * omega / r->pole_pairs);
    }
    for (int x = 0; x < 2; x++) {
        dy[10 + x] = 6.28318530717958647693 * r->bandwidth * (i_phase[x] - y[10 + x]);
    }
    dy[4] = i_phase[0];
    dy[5] = i_phase[1];
    dy[6] = 0.0;
    dy[7] = 0.0;
    for (int x = 0; x < 3; x++) {
        dy[6] += 2.0 / 3.0 * i_phase[x] * cos(theta - axis[x]);
        dy[7] -= 2.0 / 3.0 * i_phase[x] * sin(theta - axis[x]);
    }
    return 0;
}

static opened *open_solver(reference *r)
{
    opened *o = calloc(1, sizeof *o);
    must(o != NULL, "memory");
    must(SUNContext_Create(0, &o->context) == 0, "SUNContext_Create");
    o->y = N_VNew_Serial(STATES, o->context);
    o->absolute = N_VNew_Serial(STATES, o->context);
    o->cvode = CVodeCreate(r->knee > 0.0 ? CV_BDF : CV_ADAMS, o->context);
    must(o->y != NULL && o->absolute != NULL && o->cvode != NULL, "CVodeCreate");
    must(CVodeInit(o->cvode, rates, r->t, o->y) == CV_SUCCESS, "CVodeInit");
    /* The integrals are a cycle (1e-4 s) times the current, so their tolerance is that much smaller. */
    const double absolute[STATES] = {1e-12, 1e-12, 1e-13, 1e-10, 1e-17, 1e-17,
                                     1e-17, 1e-17, 1e-12, 1e-12, 1e-12, 1e-12};
    for (int n = 0; n < STATES; n++) {
        N_VGetArrayPointer(o->absolute)[n] =
            absolute[n] * (r->knee > 0.0 ? TOLERANCE_STIFF / TOLERANCE : 1.0);
    }
    const double relative = r->knee > 0.0 ? TOLERANCE_STIFF : TOLERANCE;
    must(CVodeSVtolerances(o->cvode, relative, o->absolute) == CV_SUCCESS, "CVodeSVtolerances");
    if (r->knee > 0.0) {
        o->matrix = SUNDenseMatrix(STATES, STATES, o->context);
        o->linear = SUNLinSol_Dense(o->y, o->matrix, o->context);
        must(CVodeSetLinearSolver(o->cvode, o->linear, o->matrix) == CV_SUCCESS, "CVodeSetLinearSolver");
    } else {
        o->fixed_point = SUNNonlinSol_FixedPoint(o->y, 0, o->context);
        must(CVodeSetNonlinearSolver(o->cvode, o->fixed_point) == CV_SUCCESS, "CVodeSetNonlinearSolver");
    }
    must(CVodeSetUserData(o->cvode, r) == CV_SUCCESS, "CVodeSetUserData");
    must(CVodeSetMaxNumSteps(o->cvode, 100000) == CV_SUCCESS, "CVodeSetMaxNumSteps");
    return o;
}

void reference_advance(reference *r, double dt)
{
    if (dt <= 0.0) {
        return;
    }
    if (r->solver == NULL) {
        r->solver = open_solver(r);
    }
    opened *o = r->solver;
    double *y = N_VGetArrayPointer(o->y);
    for (int n = 0; n < STATES; n++) {
        y[n] = r->y[n];
    }
    /* Time starts at zero in each span: a span of nanoseconds late in a run would be lost in its rounding. */
    double reached = 0.0;
    must(CVodeReInit(o->cvode, 0.0, o->y) == CV_SUCCESS, "CVodeReInit");
    must(CVodeSetStopTime(o->cvode, dt) == CV_SUCCESS, "CVodeSetStopTime");
    must(CVode(o->cvode, dt, o->y, &reached, CV_NORMAL) >= 0, "CVode");
    for (int n = 0; n < STATES; n++) {
        r->y[n] = y[n];
    }
    r->t += dt;
}

void reference_clear(reference *r)
{
    for (int n = 4; n < 8; n++) {
        r->y[n] = 0.0;
    }
}

void reference_close(reference *r)
{
    opened *o = r->solver;
    if (o != NULL) {
        CVodeFree(&o->cvode);
        if (o->fixed_point != NULL) {
            SUNNonlinSolFree(o->fixed_point);
        } else {
            SUNLinSolFree(o->linear);
            SUNMatDestroy(o->matrix);
        }
        N_VDestroy(o->y);
        N_VDestroy(o->absolute);
        SUNContext_Free(&o->context);
        free(o);
    }
    r->solver = NULL;
}

void reference_cycle(reference *r, const double duty[3], double T, double u_dc)
{
    double edge[8] = {0.0};
    int edges = 1;
    for (int x = 0; x < 3; x++) {
        if (duty[x] > 0.0 && duty[x] < 1.0) {
            edge[edges++] = 0.5 * T - 0.5 * T * duty[x];
            edge[edges++] = 0.5 * T + 0.5 * T * duty[x];
        }
    }
    edge[edges++] = T;
    for (int a = 1; a < edges; a++) { /* insertion sort */
        for (int b = a; b > 0 && edge[b] < edge[b - 1]; b--) {
            const double swap = edge[b];
            edge[b] = edge[b - 1];
            edge[b - 1] = swap;
        }
    }
    reference_clear(r);
    for (int n = 0; n + 1 < edges; n++) {
        const double middle = 0.5 * (edge[n] + edge[n + 1]);
        for (int x = 0; x < 3; x++) {
            const bool high = fabs(middle - 0.5 * T) < 0.5 * T * duty[x];
            r->u_leg[x] = high ? u_dc : 0.0;
        }
        reference_advance(r, edge[n + 1] - edge[n]);
    }
}
