#include "sweep_special.h"

#include "base/json_file.h"
#include "base/out_folder.h"
#include "reproduce/induction_table.h"
#include "reproduce/mean_map.h"

#include <stdio.h>
#include <string.h>

static bool write_map(const char *path, const motor *m, const mean_map *map, error *e)
{
    json_t *root = json_pack("{s:s, s:o}", "motor", m->name, "points", mean_map_json(map));
    const bool ok = path != NULL && json_file_write(path, root, e);
    json_decref(root);
    return ok;
}

bool sweep_map(const motor *m, const char *directory, const char *json_path, error *e)
{
    static mean_map map;
    out_folder f = {0};
    if (directory == NULL && json_path == NULL) {
        directory = "sweep-map";
    }
    bool ok = out_folder_open(&f, directory, e) && mean_map_run(m, &map, e) &&
              (f.stage == NULL || mean_map_page(f.stage, m, &map, e)) &&
              (json_path == NULL || write_map(out_folder_place(&f, json_path, e), m, &map, e));
    ok = out_folder_close(&f, ok, e);
    if (ok && directory != NULL && (json_path == NULL || strcmp(json_path, "-") != 0)) {
        printf("The map: %s/index.html, %s/mean-map.svg\n", directory, directory);
    }
    return ok;
}

static void print_induction(const induction_errors points[INDUCTION_POINTS])
{
    static const char *const columns[2] = {"mean", "prediction"};
    printf("Traction induction machine, rated current, 500 Hz switching; errors in percent of the rms "
           "current\n");
    printf("%10s  %8s  %8s", "", "", "");
    for (int k = 0; k < 2; k++) {
        printf("  %10s  %14s  %10s  %12s", columns[k], columns[k], columns[k], columns[k]);
    }
    printf("\n%10s  %8s  %8s", "stator Hz", "SFFR", "psi Wb");
    for (int k = 0; k < 2; k++) {
        printf("  %10s  %14s  %10s  %12s", "standard", "quasi-discrete", "exact", "with ripple");
    }
    putchar('\n');
    for (int n = 0; n < INDUCTION_POINTS; n++) {
        const induction_errors *p = &points[n];
        printf("%10.4g  %8.4g  %8.3g", p->f_stator_Hz, p->sffr, p->psi_Wb);
        printf("  %10.4g  %14.4g  %10.4g  %12.4g", p->mean_standard, p->mean_quasi_discrete, p->mean_exact,
               p->mean_pulses_iq24);
        printf("  %10.4g  %14.4g  %10.4g  %12.4g\n", p->prediction_standard, p->prediction_quasi_discrete,
               p->prediction_exact, p->prediction_pulses_iq24);
    }
}

bool sweep_induction(const char *json_path, error *e)
{
    induction_errors points[INDUCTION_POINTS];
    for (int n = 0; n < INDUCTION_POINTS; n++) {
        if (!induction_errors_at(induction_table_Hz[n], &points[n], e)) {
            return false;
        }
    }
    if (json_path != NULL) {
        json_t *root = induction_table_json(points);
        const bool ok = json_file_write(json_path, root, e);
        json_decref(root);
        if (!ok) {
            return false;
        }
    }
    if (json_path == NULL || strcmp(json_path, "-") != 0) {
        print_induction(points);
    }
    return true;
}
