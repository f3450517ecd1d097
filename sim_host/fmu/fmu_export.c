/* The parts of an FMU, put together (fmu_export.h). */

#include "fmu_export.h"

#include "base/text_out.h"
#include "fmu_archive.h"
#include "fmu_binary.h"
#include "fmu_description.h"
#include "fmu_model.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#if defined(__x86_64__)
#define PLATFORM "x86_64-linux"
#elif defined(__aarch64__)
#define PLATFORM "aarch64-linux"
#else
#error "FMI 3.0 names the machines that it knows in section 2.5.1.4.3; add this one"
#endif

/* What was just read as a motor or scenario, once more as it is. */
static bool read_text(const char *path, text_out *t, error *e)
{
    FILE *in = fopen(path, "rb");
    if (in == NULL) {
        return error_failure(e, errno, "%s", path);
    }
    char part[4096];
    size_t got = 0;
    const bool opened = text_out_open(t);
    while (opened && (got = fread(part, 1, sizeof part, in)) > 0) {
        (void)fwrite(part, 1, got, t->stream);
    }
    const bool read = ferror(in) == 0;
    const int why = errno;
    const bool kept = text_out_close(t);
    (void)fclose(in);
    if (!kept) {
        return error_failure(e, 0, "out of memory for %s", path);
    }
    if (!read) {
        return error_failure(e, why, "%s", path);
    }
    return t->length > 0 || error_input(e, path, 0, 0, "expected a file that can be read twice");
}

static bool take(const fmu_request *r, fmu_setup *s, error *e)
{
    memset(s, 0, sizeof *s);
    s->kind = r->kind;
    s->run = r->run;
    s->seed = r->seed;
    s->effects = r->effects;
    for (int k = 0; k < r->effects; k++) {
        if (strlen(r->effect[k]) >= FMU_EFFECT_SIZE) {
            return error_input(e, NULL, 0, 0, "the effect %.40s... is too long", r->effect[k]);
        }
        (void)snprintf(s->effect[k], FMU_EFFECT_SIZE, "%s", r->effect[k]);
    }
    if (!fmu_setup_read_files(s, r->motor_path, r->scenario_path, e)) {
        return false;
    }
    if (s->has_scenario && r->run >= s->scenario.runs) {
        error_input(e, r->scenario_path, 0, 0, "there is no run %zu; the last is %zu", r->run + 1,
                    s->scenario.runs);
        fmu_setup_free(s);
        return false;
    }
    return true;
}

/* A text that a call of write makes. */
static bool print(text_out *t, void (*write)(FILE *out, const fmu_model *m), const fmu_model *m, error *e)
{
    if (text_out_open(t)) {
        write(t->stream, m);
    }
    return text_out_close(t) || error_failure(e, 0, "out of memory for the FMU's files");
}

/* The effects have been applied, so that nothing in them needs an escape. */
static void write_setup(FILE *out, const fmu_model *m)
{
    const fmu_setup *s = &m->setup;
    fprintf(out, "kind = \"%s\"\nseed = %ld\nscenario = %s\nrun = %zu\n", fmu_kind_words[s->kind], s->seed,
            s->has_scenario ? "true" : "false", s->run + 1);
    if (s->token[0] != '\0') {
        fprintf(out, "token = \"%s\"\n", s->token);
    }
    for (int k = 0; k < s->effects; k++) {
        fprintf(out, "[[effect]]\nis = \"%s\"\n", s->effect[k]);
    }
}

typedef struct parts {
    text_out motor, scenario, setup, description;
} parts;

/* The token follows from all that makes the FMU differ from another. */
static void make_token(fmu_setup *s, const parts *p)
{
    const text_out *of[] = {&p->motor, &p->scenario, &p->setup};
    uLong sum = crc32(0, fmu_library, (uInt)fmu_library_size());
    uLong other = adler32(0, NULL, 0);
    for (int k = 0; k < 3; k++) {
        sum = crc32(sum, (const Bytef *)of[k]->bytes, (uInt)of[k]->length);
        other = adler32(other, (const Bytef *)of[k]->bytes, (uInt)of[k]->length);
    }
    (void)snprintf(s->token, sizeof s->token, "{iqfoc-%08lx-%08lx}", sum, other);
}

static bool make_parts(const fmu_request *r, fmu_model *m, parts *p, error *e)
{
    if (!read_text(r->motor_path, &p->motor, e) ||
        (m->setup.has_scenario && !read_text(r->scenario_path, &p->scenario, e)) ||
        !print(&p->setup, write_setup, m, e)) {
        return false;
    }
    make_token(&m->setup, p);
    free(p->setup.bytes);
    return print(&p->setup, write_setup, m, e) && print(&p->description, fmu_description_write, m, e);
}

static bool pack(const fmu_request *r, const parts *p, error *e)
{
    fmu_archive a;
    if (!fmu_archive_open(&a, r->out_path, e)) {
        return false;
    }
    const bool ok =
        fmu_archive_add(&a, "modelDescription.xml", p->description.bytes, p->description.length, e) &&
        fmu_archive_add(&a, "binaries/" PLATFORM "/" FMU_IDENTIFIER ".so", fmu_library, fmu_library_size(),
                        e) &&
        fmu_archive_add(&a, "resources/motor.toml", p->motor.bytes, p->motor.length, e) &&
        (p->scenario.bytes == NULL ||
         fmu_archive_add(&a, "resources/scenario.toml", p->scenario.bytes, p->scenario.length, e)) &&
        fmu_archive_add(&a, "resources/setup.toml", p->setup.bytes, p->setup.length, e);
    return fmu_archive_close(&a, ok, e);
}

bool fmu_export(const fmu_request *r, error *e)
{
    fmu_setup s;
    parts p = {0};
    iqfoc_cycle_config_t unused;
    fmu_model *m = calloc(1, sizeof *m);
    if (m == NULL) {
        return error_failure(e, 0, "out of memory for the FMU");
    }
    if (!take(r, &s, e)) {
        free(m);
        return false;
    }
    s.motor.path = r->motor_path;
    const bool ok = fmu_model_load(m, &s, e) &&
                    config_from_motor(&s.motor, &s.scenario.control, &unused, e) && make_parts(r, m, &p, e) &&
                    pack(r, &p, e);
    free(p.motor.bytes);
    free(p.scenario.bytes);
    free(p.setup.bytes);
    free(p.description.bytes);
    fmu_model_free(m);
    free(m);
    return ok;
}
