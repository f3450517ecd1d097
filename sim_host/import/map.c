#include "map.h"

#include "base/number.h"
#include "data/toml_table.h"

#include <math.h>
#include <string.h>

static const char delimiter_marks[] = {',', ';', '\t', ' '};
static const char *const delimiter_words[] = {",", ";", "tab", "blank"};
static const char *const decimal_words[] = {".", ","};

import_map map_blank(void)
{
    import_map m = {.format = LOG_FORMAT_UNKNOWN, .decimation = 1};
    for (int q = 0; q < QUANTITY_COUNT; q++) {
        size_t count;
        m.column[q].scale = 1.0;
        m.column[q].unit = quantity_units(quantity_dimension((quantity)q), &count);
    }
    return m;
}

void map_put(import_map *m, quantity q, const char *from, const char *unit_word)
{
    map_column *c = &m->column[q];
    const quantity_unit *u = unit_word != NULL ? quantity_unit_find(quantity_dimension(q), unit_word) : NULL;
    c->there = true;
    snprintf(c->from, sizeof c->from, "%s", from);
    c->unit = u != NULL ? u : c->unit;
}

/* ---- reading ---- */

/* fields = [["t", "u32"], ["i_a", "f32"], ...] */
static void read_fields(toml_table *t, binary_format *b)
{
    const size_t fields = toml_pairs(t, "fields");
    if (fields == 0 || fields > BINARY_FIELDS_MOST) {
        toml_refuse(t, "fields",
                    "fields must list 1 to %d pairs of a name and a type, such as [[\"t\", \"u32\"], "
                    "[\"i_a\", \"f32\"]]",
                    BINARY_FIELDS_MOST);
        return;
    }
    for (size_t n = 0; n < fields; n++) {
        b->field[n].kind = (binary_kind)toml_pair_at(
            t, "fields", n, b->field[n].name, sizeof b->field[n].name, binary_kind_words, BINARY_KINDS);
        for (size_t other = 0; other < n; other++) {
            if (strcmp(b->field[other].name, b->field[n].name) == 0) {
                toml_refuse(t, "fields", "fields: \"%s\" is there twice; expected a name for each",
                            b->field[n].name);
            }
        }
    }
    b->fields = fields;
}

static void read_binary(toml_table *t, binary_format *b)
{
    static const char *const frames[] = {"fixed", "slip"};
    static const char *const orders[] = {"little", "big"};
    b->slip = toml_choice_or(t, "frame", frames, 2, 0) == 1;
    b->big_endian = toml_choice_or(t, "endian", orders, 2, 0) == 1;
    b->skip = toml_integer_or(t, "skip", 0, 1000000000, 0);
    read_fields(t, b);
}

static void read_format(toml_table *t, log_format *f, binary_format *b)
{
    static const char *const types[] = {"text", "binary"};
    if (toml_choice_or(t, "type", types, 2, 0) == 1) {
        read_binary(t, b);
        return;
    }
    const size_t delimiters = sizeof delimiter_marks;
    const size_t d = toml_choice_or(t, "delimiter", delimiter_words, delimiters, delimiters);
    const size_t mark = toml_choice_or(t, "decimal", decimal_words, 2, 2);
    f->encoding = (log_encoding)toml_choice_or(t, "encoding", log_encoding_words, ENCODING_COUNT, 0);
    f->delimiter = d < delimiters ? delimiter_marks[d] : (char)0;
    f->decimal = mark < 2 ? decimal_words[mark][0] : (char)0;
    f->skip = toml_integer_or(t, "skip", 0, LOG_HEAD_LINES - 1, -1);
}

static void read_unit(toml_table *t, quantity q, map_column *c)
{
    size_t count;
    const quantity_unit *units = quantity_units(quantity_dimension(q), &count);
    const char *words[8];
    for (size_t n = 0; n < count; n++) {
        words[n] = units[n].word;
    }
    c->unit = &units[toml_choice_or(t, "unit", words, count, 0)];
    const bool is_angle = quantity_dimension(q) == DIMENSION_ANGLE;
    if (is_angle && c->unit->factor == 0.0) {
        c->per_turn = toml_number(t, "per_turn", TOML_POSITIVE);
    }
    if (is_angle) {
        c->zero = toml_number_or(t, "zero", TOML_ANY, 0.0);
    }
    if (q == QUANTITY_THETA || q == QUANTITY_OMEGA) {
        c->mechanical = toml_flag_or(t, "mechanical", false);
    }
    if (q == QUANTITY_U_D || q == QUANTITY_U_Q) {
        c->ahead = toml_number_or(t, "ahead", (toml_range){-4.0, 4.0, false}, 0.0);
    }
}

static void read_column(toml_table *columns, quantity q, map_column *c)
{
    const char *key = quantity_key(q);
    if (!toml_has(columns, key)) {
        return;
    }
    c->there = true;
    toml_position(columns, key, &c->line, &c->at);
    if (!toml_is_table(columns, key)) {
        toml_text_or_keep(columns, key, c->from, sizeof c->from);
        return;
    }
    toml_table *t = toml_table_inner(columns, key);
    if (!toml_has(t, "from")) {
        toml_refuse(columns, key, "%s: from is missing; expected the name of a column of the log", key);
    }
    toml_text_or_keep(t, "from", c->from, sizeof c->from);
    c->scale = toml_number_or(t, "scale", TOML_ANY, 1.0);
    c->offset = toml_number_or(t, "offset", TOML_ANY, 0.0);
    if (c->scale == 0.0) {
        toml_refuse(t, "scale", "%s: scale must not be 0", key);
    }
    read_unit(t, q, c);
}

static void read_pwm(toml_table *t, map_pwm *p)
{
    if (t == NULL) {
        return;
    }
    p->there = toml_has(t, "frame") || toml_has(t, "centre") || toml_has(t, "inverted");
    p->frame = toml_number_or(t, "frame", TOML_POSITIVE, 1.0);
    p->centre = toml_number_or(t, "centre", TOML_ANY, 0.5 * p->frame);
    p->inverted = toml_flag_or(t, "inverted", false);
}

static void read_timing(toml_table *t, import_map *m)
{
    long at;
    m->rate_Hz = toml_number_or(t, "rate_Hz", TOML_POSITIVE, 0.0);
    m->decimation = toml_integer_or(t, "decimation", 1, 1000000, 1);
    toml_position(t, "decimation", &m->decimation_line, &at);
    m->shift_cycles = toml_number_or(t, "shift_cycles", (toml_range){-4.0, 4.0, false}, 0.0);
    if (2.0 * m->shift_cycles != floor(2.0 * m->shift_cycles)) {
        toml_refuse(t, "shift_cycles", "shift_cycles must be whole or half cycles, not %g", m->shift_cycles);
    }
}

static void read_fixed(toml_table *t, import_map *m)
{
    m->has_fixed_u_dc = toml_has(t, "u_dc_V");
    m->has_fixed_omega = toml_has(t, "omega_e_rad_s");
    m->has_fixed_theta = toml_has(t, "theta_e_rad");
    m->u_dc_V = toml_number_or(t, "u_dc_V", TOML_POSITIVE, 0.0);
    m->omega_e_rad_s = toml_number_or(t, "omega_e_rad_s", TOML_ANY, 0.0);
    m->theta_e_rad = toml_number_or(t, "theta_e_rad", TOML_ANY, 0.0);
}

bool map_read(const char *path, import_map *m, error *e)
{
    *m = map_blank();
    m->path = path;
    toml_file *file = toml_file_open(path, e);
    toml_table *root = toml_file_root(file);
    toml_table *columns = toml_table_inner(root, "columns");
    toml_table *pwm = toml_table_inner_or_null(root, "pwm");
    toml_table *sensors = toml_table_inner_or_null(root, "sensors");
    read_format(toml_table_inner_or_null(root, "format"), &m->format, &m->binary);
    for (int q = 0; q < QUANTITY_COUNT; q++) {
        read_column(columns, (quantity)q, &m->column[q]);
    }
    read_pwm(pwm, &m->pwm);
    m->updates = pwm_updates_read(pwm, sensors);
    m->updates_stated = !pwm_updates_is_plain(&m->updates);
    read_timing(toml_table_inner_or_null(root, "timing"), m);
    read_fixed(toml_table_inner_or_null(root, "fixed"), m);
    return toml_file_close(file);
}

bool map_open_log(const import_map *m, log_table *t, const char *path, error *e)
{
    return m->binary.fields > 0 ? log_binary_open(t, path, &m->binary, e)
                                : log_table_open(t, path, &m->format, e);
}

/* ---- printing ---- */

static void put_number(FILE *out, const char *key, double value, double absent)
{
    char text[NUMBER_TEXT_SIZE];
    if (value != absent) {
        number_text(value, text);
        fprintf(out, ", %s = %s", key, text);
    }
}

static void put_text(FILE *out, const char *text)
{
    fputc('"', out);
    for (; *text != '\0'; text++) {
        if (*text == '"' || *text == '\\') {
            fputc('\\', out);
        }
        fputc(*text, out);
    }
    fputc('"', out);
}

void map_print_column(FILE *out, const import_map *m, quantity q)
{
    const map_column *c = &m->column[q];
    size_t count;
    fprintf(out, "%s = { from = ", quantity_key(q));
    put_text(out, c->from);
    put_number(out, "scale", c->scale, 1.0);
    put_number(out, "offset", c->offset, 0.0);
    if (c->unit != quantity_units(quantity_dimension(q), &count)) {
        fprintf(out, ", unit = \"%s\"", c->unit->word);
    }
    put_number(out, "per_turn", c->per_turn, 0.0);
    put_number(out, "zero", c->zero, 0.0);
    put_number(out, "ahead", c->ahead, 0.0);
    fprintf(out, "%s }\n", c->mechanical ? ", mechanical = true" : "");
}

static void print_format(FILE *out, const log_format *f)
{
    fprintf(out, "[format]\n");
    for (size_t d = 0; d < sizeof delimiter_marks; d++) {
        if (f->delimiter == delimiter_marks[d]) {
            fprintf(out, "delimiter = \"%s\"\n", delimiter_words[d]);
        }
    }
    if (f->decimal != 0) {
        fprintf(out, "decimal = \"%c\"\n", f->decimal);
    }
    if (f->encoding != ENCODING_AUTO) {
        fprintf(out, "encoding = \"%s\"\n", log_encoding_words[f->encoding]);
    }
    if (f->skip >= 0) {
        fprintf(out, "skip = %ld\n", f->skip);
    }
}

void map_print(FILE *out, const import_map *m)
{
    char text[NUMBER_TEXT_SIZE];
    if (m->format.delimiter != 0 || m->format.decimal != 0 || m->format.skip >= 0) {
        print_format(out, &m->format);
        fputc('\n', out);
    }
    fprintf(out, "[columns]\n");
    for (int q = 0; q < QUANTITY_COUNT; q++) {
        if (m->column[q].there) {
            map_print_column(out, m, (quantity)q);
        }
    }
    if (m->pwm.there) {
        number_text(m->pwm.frame, text);
        fprintf(out, "\n[pwm]\nframe = %s\n", text);
        number_text(m->pwm.centre, text);
        fprintf(out, "centre = %s\ninverted = %s\n", text, m->pwm.inverted ? "true" : "false");
    }
    if (m->rate_Hz > 0.0 || m->shift_cycles != 0.0 || m->decimation != 1) {
        fprintf(out, "\n[timing]\n");
    }
    if (m->rate_Hz > 0.0) {
        number_text(m->rate_Hz, text);
        fprintf(out, "rate_Hz = %s\n", text);
    }
    if (m->decimation != 1) {
        fprintf(out, "decimation = %ld\n", m->decimation);
    }
    if (m->shift_cycles != 0.0) {
        fprintf(out, "shift_cycles = %g\n", m->shift_cycles);
    }
    if (m->has_fixed_u_dc) {
        number_text(m->u_dc_V, text);
        fprintf(out, "\n[fixed]\nu_dc_V = %s\n", text);
    }
}
