#include "sweep_special.h"

#include "base/json_file.h"
#include "base/out_folder.h"
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
