/* iqfoc sweep --map: its files (sweep_special.h). */
#include "sweep_special.h"

#include "base/json_file.h"
#include "base/out_folder.h"
#include "reproduce/mean_map.h"

#include <stdio.h>

bool sweep_map(const motor *m, const char *directory, const char *json_path, error *e)
{
    static mean_map map;
    out_folder f = {0};
    if (directory == NULL && json_path == NULL) {
        directory = "sweep-map";
    }
    bool ok = out_folder_open(&f, directory, e) && mean_map_run(m, &map, e) &&
              (f.stage == NULL || mean_map_page(f.stage, m, &map, e)) &&
              json_file_place(&f, json_path,
                              json_pack("{s:s, s:o}", "motor", m->name, "points", mean_map_json(&map)), e);
    ok = out_folder_close(&f, ok, e);
    if (ok && directory != NULL && !json_file_is_stdout(json_path)) {
        printf("The map: %s/index.html, %s/mean-map.svg\n", directory, directory);
    }
    return ok;
}
