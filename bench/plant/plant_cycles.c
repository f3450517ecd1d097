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

static const struct {
    const char *name;
    int cycles; /* in one of the runs */
} drives[] = {
    {"given speed", 20000},
    {"salient", 20000},
    {"free shaft", 5000},
    {"saturation", 5000},
    {"dead time", 5000},
    {"dead time, drops, saturation", 5000},
    {"current filter, 20 kHz", 20000},
    {"current filter, 1 MHz", 20000},
};

#define DRIVES (sizeof drives / sizeof drives[0])

static plant_config configured(const char *name)
{
    motor m = laboratory_motor();
    plant_config c = plant_config_from_motor(&m);
    c.shaft.omega_e_start_rad_s = 942.0;
    if (strcmp(name, "salient") == 0) {
        c.machine.L_q_H *= 2.0;
    }
    if (strcmp(name, "free shaft") == 0) {
        c.shaft.mode = PLANT_SHAFT_INERTIA;
        c.shaft.J_kgm2 = 1e-2;
    }
    if (strstr(name, "saturation") != NULL) {
        c.machine.I_sat_A = 40.0;
    }
    if (strstr(name, "dead time") != NULL) {
        c.inverter.t_dead_s = 2e-6;
    }
    if (strstr(name, "drops") != NULL) {
        c.inverter.v_switch_V = 1.5;
        c.inverter.v_diode_V = 1.2;
        c.machine.psi_5_Wb = 0.003;
    }
    if (strstr(name, "20 kHz") != NULL) {
        c.sensors.current_bandwidth_Hz = 20e3;
    }
    if (strstr(name, "1 MHz") != NULL) {
        c.sensors.current_bandwidth_Hz = 1e6;
    }
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
        const plant_config c = configured(drives[d].name);
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
            const plant_config c = configured(argv[1]);
            return isfinite(simulate(&c, atoi(argv[2]))) ? EXIT_SUCCESS : EXIT_FAILURE;
        }
    }
    fputs("usage: plant_cycles [DRIVE CYCLES]\n", stderr);
    return 2;
}
