/* An effect's text, read and put into the configuration (plant_effect.h). */
#include "plant_effect.h"
#include "../base/number.h"
#include "../base/suggest.h"
#include "plant_effect_table.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

static int key_count(const effect *f)
{
    int n = 0;
    while (n < EFFECT_KEYS_MAX && f->key[n].name != NULL) {
        n++;
    }
    return n;
}

static double typical_value(const plant_config *c, const effect_key *key)
{
    const double L_H = 0.5 * (c->machine.L_d_H + c->machine.L_q_H);
    double itself = L_H;
    if (key->kind != KEY_MEAN_INDUCTANCE && key->kind != KEY_BOTH_INDUCTANCES && key->of == OF_ITSELF) {
        memcpy(&itself, (const char *)c + key->offset, sizeof itself);
    }
    const double unit[] = {[ABSOLUTE] = 1.0,
                           [OF_ITSELF] = itself,
                           [OF_RATED] = c->I_scale_A,
                           [OF_CYCLE] = c->T_s,
                           [OF_LINK] = c->inverter.u_dc_V,
                           [OF_MAGNET] = c->machine.psi_f_Wb,
                           [OF_RESISTANCE] = c->machine.R_ohm,
                           [OF_INDUCTANCE] = L_H,
                           [OF_MAP_THIRD] = L_H / c->I_scale_A,
                           [OF_MAP_FOURTH] = L_H / (c->I_scale_A * c->I_scale_A)};
    return key->typical * unit[key->of];
}

/* False: the value is none of the key's kind. */
static bool set_key(plant_config *c, const effect_key *key, double value)
{
    const bool whole = value == floor(value) && fabs(value) < 1e9;
    char *field = (char *)c + key->offset;
    switch (key->kind) {
    case KEY_REAL:
        memcpy(field, &value, sizeof value);
        return true;
    case KEY_WHOLE: {
        const int number = whole ? (int)value : 0;
        memcpy(field, &number, sizeof number);
        return whole;
    }
    case KEY_FLAG: {
        const bool flag = value == 1.0;
        memcpy(field, &flag, sizeof flag);
        return value == 0.0 || value == 1.0;
    }
    case KEY_BOTH_INDUCTANCES:
        c->machine.L_d_H = value;
        c->machine.L_q_H = value;
        return true;
    case KEY_MEAN_INDUCTANCE: {
        const double scale = value / (0.5 * (c->machine.L_d_H + c->machine.L_q_H));
        c->machine.L_d_H *= scale;
        c->machine.L_q_H *= scale;
        return true;
    }
    }
    return false;
}

/* "R" or "R_ohm". */
static bool is_name_of(const effect_key *key, const char *text, size_t length)
{
    const size_t name = strlen(key->name);
    if (length < name || strncmp(text, key->name, name) != 0) {
        return false;
    }
    const size_t unit = strlen(key->unit);
    return length == name ||
           (length == name + 1 + unit && text[name] == '_' && strncmp(text + name + 1, key->unit, unit) == 0);
}

/* "R (ohm), ..." for a message. */
static void name_keys(const effect *f, char *text, size_t size)
{
    text[0] = '\0';
    for (int k = 0; k < key_count(f); k++) {
        const size_t used = strlen(text);
        (void)snprintf(text + used, size - used, "%s%s (%s)", k > 0 ? ", " : "", f->key[k].name,
                       f->key[k].unit);
    }
}

static const effect *find(const char *text, size_t length)
{
    for (int k = 0; k < effect_table_length; k++) {
        if (strlen(effect_table[k].id) == length && strncmp(effect_table[k].id, text, length) == 0) {
            return &effect_table[k];
        }
    }
    return NULL;
}

/* One "key=value" of the text. */
static bool take_setting(plant_config *c, const effect *f, const char *text, const char *setting,
                         size_t length, bool seen[EFFECT_KEYS_MAX], error *e)
{
    char known[400];
    name_keys(f, known, sizeof known);
    const char *equals = memchr(setting, '=', length);
    const size_t name = equals != NULL ? (size_t)(equals - setting) : length;
    const int shown = (int)length;
    if (equals == NULL) {
        return error_input(e, NULL, 0, 0, "effect \"%s\": \"%.*s\" has no '='; expected key=value of %s",
                           text, shown, setting, known);
    }
    for (int k = 0; k < key_count(f); k++) {
        if (!is_name_of(&f->key[k], setting, name)) {
            continue;
        }
        if (seen[k]) {
            return error_input(e, NULL, 0, 0, "effect \"%s\": %s is given twice", text, f->key[k].name);
        }
        seen[k] = true;
        double value = 0.0;
        const number_result result = number_parse(equals + 1, length - name - 1, &value);
        if (result != NUMBER_OK) {
            return error_input(e, NULL, 0, 0, "effect \"%s\": the value of %s %s; expected a number in %s",
                               text, f->key[k].name, number_complaint(result), f->key[k].unit);
        }
        if (!set_key(c, &f->key[k], value)) {
            const char *expected = f->key[k].kind == KEY_FLAG ? "0 or 1" : "a whole number";
            return error_input(e, NULL, 0, 0, "effect \"%s\": %s is %g, expected %s", text, f->key[k].name,
                               value, expected);
        }
        return true;
    }
    const char *names[EFFECT_KEYS_MAX];
    for (int k = 0; k < key_count(f); k++) {
        names[k] = f->key[k].name;
    }
    char given[64];
    (void)snprintf(given, sizeof given, "%.*s", (int)name, setting);
    const char *meant = suggest(given, names, (size_t)key_count(f));
    return error_input(e, NULL, 0, 0, "effect \"%s\": unknown key \"%s\", expected one of %s%s%s%s", text,
                       given, known, meant != NULL ? "; did you mean " : "", meant != NULL ? meant : "",
                       meant != NULL ? "?" : "");
}

/* Without these the effect would not be there: a ripple of no frequency. */
static void complete(plant_config *c, const effect *f, const bool seen[EFFECT_KEYS_MAX])
{
    for (int k = 0; k < key_count(f); k++) {
        double value = 0.0;
        if (f->key[k].needed && !seen[k]) {
            /* All of them are real numbers. */
            memcpy(&value, (const char *)c + f->key[k].offset, sizeof value);
            (void)set_key(c, &f->key[k], value != 0.0 ? value : typical_value(c, &f->key[k]));
        }
    }
}

/* At most as many as there are causes, and what has no name; more would be left out of the search for what was meant. */
enum { IDS_MOST = 64 };

static bool refuse_id(const char *text, size_t length, error *e)
{
    char id[64];
    const char *known[IDS_MOST];
    size_t count = 0;
    (void)snprintf(id, sizeof id, "%.*s", (int)length, text);
    while (count < IDS_MOST && count < (size_t)effect_table_length) {
        known[count] = effect_table[count].id;
        count++;
    }
    const char *meant = suggest(id, known, count);
    return error_input(e, NULL, 0, 0,
                       meant != NULL
                           ? "effect \"%s\": unknown id \"%s\"; did you mean %s?"
                           : "effect \"%s\": unknown id \"%s\"; `iqfoc simulate --list-effects` lists them",
                       text, id, meant);
}

/* An angle's error that is given again is another one: what was given so far makes room for it. */
static void make_room(plant_config *c, const effect *f)
{
    plant_harmonic *h = c->sensors.harmonic;
    if (f->key[0].offset != offsetof(plant_config, sensors.harmonic[0].order) || h[0].amplitude_rad == 0.0) {
        return;
    }
    int last = PLANT_HARMONICS - 1;
    while (last > 1 && h[last - 1].amplitude_rad == 0.0) {
        last--;
    }
    memmove(h + 1, h, (size_t)last * sizeof *h);
    h[0] = (plant_harmonic){.order = 1.0};
}

bool plant_effect_apply(plant_config *c, const char *text, error *e)
{
    const size_t id_length = strcspn(text, ":");
    const effect *f = find(text, id_length);
    if (f == NULL) {
        return refuse_id(text, id_length, e);
    }
    plant_config changed = *c;
    if (f->key[0].offset == offsetof(plant_config, inverter.ripple_V)) {
        changed.inverter.ripple_logged = false;
    }
    make_room(&changed, f);
    if (text[id_length] == '\0') {
        for (int k = 0; k < key_count(f); k++) {
            (void)set_key(&changed, &f->key[k], typical_value(c, &f->key[k]));
        }
    } else {
        bool seen[EFFECT_KEYS_MAX] = {false};
        const char *setting = text + id_length;
        while (*setting != '\0') {
            setting++; /* past ':' or ',' */
            const size_t length = strcspn(setting, ",");
            if (!take_setting(&changed, f, text, setting, length, seen, e)) {
                return false;
            }
            setting += length;
        }
        complete(&changed, f, seen);
    }
    error wrong = {0};
    if (!plant_config_check(&changed, &wrong)) {
        return error_input(e, NULL, 0, 0, "effect \"%s\": %s", text, wrong.text);
    }
    *c = changed;
    return true;
}

/* "R = 1.3 times the drive's, ...": the sizes of an effect without keys; those of zero are left out. */
static void list_defaults(FILE *stream, const effect *f)
{
    static const char *const times[] = {[ABSOLUTE] = "",
                                        [OF_ITSELF] = " times the drive's",
                                        [OF_RATED] = " times the rated peak current",
                                        [OF_CYCLE] = " control cycles",
                                        [OF_LINK] = " times u_dc",
                                        [OF_MAGNET] = " times psi_f",
                                        [OF_RESISTANCE] = " times R",
                                        [OF_INDUCTANCE] = " times L",
                                        [OF_MAP_THIRD] = " times L / rated peak current",
                                        [OF_MAP_FOURTH] = " times L / rated peak current^2"};
    bool first = true;
    for (int k = 0; k < key_count(f); k++) {
        const effect_key *key = &f->key[k];
        if (key->typical != 0.0) {
            (void)fprintf(stream, "%s%s = %g%s", first ? "                        default: " : ", ",
                          key->name, key->typical, times[key->of]);
            first = false;
        }
    }
    (void)fputs(first ? "" : "\n", stream);
}

void plant_effect_list(FILE *stream)
{
    for (int k = 0; k < effect_table_length; k++) {
        char keys[400];
        name_keys(&effect_table[k], keys, sizeof keys);
        (void)fprintf(stream, "  %-21s %s: %s\n", effect_table[k].id, effect_table[k].does, keys);
        list_defaults(stream, &effect_table[k]);
    }
}
