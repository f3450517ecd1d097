/*
 * Control cycles of the plant, samples at valley and peak and true means included, for its kinds of drive.
 *
 *     plant_cycles                   prints the cycles in a second of processor time, the best of several runs
 *     plant_cycles DRIVE CYCLES      simulates CYCLES cycles of DRIVE, for a counter of instructions
 */
#include "laboratory_motor.h"
#include "plant/plant.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define RUNS 10

/* What a drive has in addition to the laboratory motor at one speed; 0: nothing. */
typedef struct drive {
    const char *name;
    int cycles; /* in one of the runs */
    double salient, J_kgm2, I_sat_A, t_dead_s, v_switch_V, v_diode_V, psi_5_Wb, bandwidth_Hz;
} drive;

static const drive drives[] = {
    {.name = "given speed", .cycles = 20000},
    {.name = "salient", .cycles = 20000, .salient = 1.0},
    {.name = "free shaft", .cycles = 5000, .J_kgm2 = 1e-2},
    {.name = "saturation", .cycles = 5000, .I_sat_A = 40.0},
    {.name = "dead time", .cycles = 5000, .t_dead_s = 2e-6},
    {.name = "dead time, drops, saturation",
     .cycles = 5000,
     .I_sat_A = 40.0,
     .t_dead_s = 2e-6,
     .v_switch_V = 1.5,
     .v_diode_V = 1.2,
     .psi_5_Wb = 0.003},
    {.name = "current filter, 20 kHz", .cycles = 20000, .bandwidth_Hz = 20e3},
    {.name = "current filter, 1 MHz", .cycles = 20000, .bandwidth_Hz = 1e6},
};

#define DRIVES (sizeof drives / sizeof drives[0])

static plant_config configured(const drive *of)
{
    motor m = laboratory_motor();
    plant_config c = plant_config_from_motor(&m);
    c.shaft.omega_e_start_rad_s = 942.0;
    c.machine.L_q_H *= 1.0 + of->salient;
    if (of->J_kgm2 > 0.0) {
        c.shaft.mode = PLANT_SHAFT_INERTIA;
        c.shaft.J_kgm2 = of->J_kgm2;
    }
    if (of->I_sat_A > 0.0) {
        c.machine.I_sat_A = of->I_sat_A;
    }
    if (of->bandwidth_Hz > 0.0) {
        c.sensors.current_bandwidth_Hz = of->bandwidth_Hz;
    }
    c.inverter.t_dead_s = of->t_dead_s;
    c.inverter.v_switch_V = of->v_switch_V;
    c.inverter.v_diode_V = of->v_diode_V;
    c.machine.psi_5_Wb = of->psi_5_Wb;
    return c;
}

/* The sum of what the cycles put out, so that none can be left out. */
static double simulate(const plant_config *c, int cycles)
{
    plant p;
    plant_init(&p, c);
    double sum = 0.0;
    for (int k = 0; k < cycles; k++) {
        const double theta = p.state.y[STATE_THETA_E] + 0.1 + 0.5 * VEC_PI;
        double duty[3];
        for (int x = 0; x < 3; x++) {
            duty[x] = 0.5 + 0.2 * cos(theta - 2.0 * VEC_PI / 3.0 * x);
        }
        plant_samples valley, peak;
        plant_means means;
        plant_cycle(&p, duty, &valley, &peak, &means);
        sum += means.i_dq_A.q + valley.i_A[0] + peak.i_A[0];
    }
    return sum;
}

static int print_rates(void)
{
    for (size_t d = 0; d < DRIVES; d++) {
        const plant_config c = configured(&drives[d]);
        double best = INFINITY;
        for (int run = 0; run < RUNS; run++) {
            const clock_t begin = clock();
            if (!isfinite(simulate(&c, drives[d].cycles))) {
                return EXIT_FAILURE;
            }
            best = fmin(best, (double)(clock() - begin) / (double)CLOCKS_PER_SEC / drives[d].cycles);
        }
        printf("%-28s %8.0f cycles/s\n", drives[d].name, 1.0 / best);
    }
    return EXIT_SUCCESS;
}

int main(int argc, char **argv)
{
    if (argc == 1) {
        return print_rates();
    }
    for (size_t d = 0; argc == 3 && d < DRIVES; d++) {
        if (strcmp(argv[1], drives[d].name) == 0) {
            const plant_config c = configured(&drives[d]);
            return isfinite(simulate(&c, atoi(argv[2]))) ? EXIT_SUCCESS : EXIT_FAILURE;
        }
    }
    fputs("usage: plant_cycles [DRIVE CYCLES]\n", stderr);
    return 2;
}
