#include "propose.h"

#include "data/foreign_names.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The largest value of a column among the first rows. */
static double largest(const log_table *t, size_t column)
{
    double most = 0.0;
    log_field *fields = malloc(LOG_FIELDS_MOST * sizeof *fields);
    for (size_t k = t->head.first_row; fields != NULL && k < t->head.lines; k++) {
        char *copy = malloc(t->head.length[k] + 1);
        if (copy != NULL) {
            double value = 0.0;
            memcpy(copy, t->head.line[k], t->head.length[k]);
            const int count = log_line_split(copy, t->head.length[k], t->format.delimiter, fields);
            if ((int)column < count && log_field_number(&fields[column], t->format.decimal, &value)) {
                most = fmax(most, value);
            }
        }
        free(copy);
    }
    free(fields);
    return most;
}

static void put(proposal *p, const log_table *t, size_t n, quantity q, const foreign_name *known)
{
    const char *of_row = foreign_unit_find(t->unit[n], strlen(t->unit[n]));
    const char *word = of_row != NULL ? of_row : known->unit;
    map_column *c = &p->map.column[q];
    map_put(&p->map, q, t->name[n], word);
    c->mechanical = known->mechanical;
    c->per_turn = c->unit->factor == 0.0 ? 4096.0 : 0.0;
    const dimension d = quantity_dimension(q);
    p->unit_assumed[q] = d != DIMENSION_NUMBER && d != DIMENSION_TEMPERATURE && d != DIMENSION_DUTY &&
                         (word == NULL || quantity_unit_find(d, word) == NULL);
    p->found++;
}

void propose_map(const log_table *t, proposal *p)
{
    *p = (proposal){.map = map_blank()};
    p->map.format = t->format;
    p->map.format.skip = -1;
    if (!t->head.has_header) {
        return;
    }
    for (size_t n = 0; n < t->columns; n++) {
        const quantity own = quantity_find(t->name[n]);
        const foreign_name known = own != QUANTITY_COUNT ? (foreign_name){t->name[n], NULL, false}
                                                         : foreign_name_find(t->name[n], strlen(t->name[n]));
        const quantity q = known.key != NULL ? quantity_find(known.key) : QUANTITY_COUNT;
        if (q != QUANTITY_COUNT && !p->map.column[q].there) {
            put(p, t, n, q, &known);
            p->unit_assumed[q] = p->unit_assumed[q] && own == QUANTITY_COUNT;
        }
    }
    double counts = 0.0;
    for (int q = QUANTITY_D_A; q <= QUANTITY_D_C; q++) {
        if (p->map.column[q].there && p->map.column[q].unit->factor == 1.0) {
            counts = fmax(counts, largest(t, log_table_find(t, p->map.column[q].from)));
        }
    }
    if (counts > 1.001) {
        p->map.pwm = (map_pwm){true, counts, 0.5 * counts, false};
    }
}

static bool have(const proposal *p, quantity first, int count, int least)
{
    int there = 0;
    for (int n = 0; n < count; n++) {
        there += p->map.column[(int)first + n].there ? 1 : 0;
    }
    return there >= least;
}

static void print_missing(FILE *out, const proposal *p)
{
    const bool duties = have(p, QUANTITY_D_A, 3, 3);
    if (!have(p, QUANTITY_T, 1, 1)) {
        fprintf(out, "# missing: t_s; or say the rate of control cycles:\n# [timing]\n# rate_Hz = 10000\n");
    }
    if (!have(p, QUANTITY_I_A, 3, 2) && !have(p, QUANTITY_I_D, 2, 2) && !have(p, QUANTITY_I_ALPHA, 2, 2)) {
        fprintf(out,
                "# missing: two of i_a_A, i_b_A, i_c_A, or i_d_A and i_q_A, or i_alpha_A and i_beta_A\n");
    }
    if (!duties && !have(p, QUANTITY_U_A, 3, 3) && !have(p, QUANTITY_U_D, 2, 2) &&
        !have(p, QUANTITY_U_ALPHA, 2, 2) && !have(p, QUANTITY_U_AB, 3, 2)) {
        fprintf(out,
                "# missing: u_a_V to u_c_V, u_d_V and u_q_V, u_alpha_V and u_beta_V, u_ab_V and u_bc_V, or "
                "d_a, d_b, d_c\n");
    }
    if (duties && !have(p, QUANTITY_U_DC, 1, 1)) {
        fprintf(out, "# missing: u_dc_V, which the duties need; or a fixed one:\n# [fixed]\n# u_dc_V = 48\n");
    }
    if (!have(p, QUANTITY_THETA, 1, 1)) {
        fprintf(out,
                "# missing: theta_e_rad; or, for a rotor at standstill:\n# [fixed]\n# theta_e_rad = 0\n");
    }
    if (!have(p, QUANTITY_OMEGA, 1, 1)) {
        fprintf(out, "# omega_e_rad_s is not in the log: it will be the slope of the angle\n");
    }
}

static void print_unused(FILE *out, const log_table *t, const import_map *map)
{
    const char *before = "# columns that are not used: ";
    for (size_t n = 0; n < t->columns; n++) {
        bool used = false;
        for (int q = 0; q < QUANTITY_COUNT; q++) {
            used = used || (map->column[q].there && strcmp(map->column[q].from, t->name[n]) == 0);
        }
        if (!used) {
            fprintf(out, "%s\"%s\"", before, t->name[n]);
            before = ", ";
        }
    }
    fputs(before[0] == ',' ? "\n" : "", out);
}

void propose_print(FILE *out, const log_table *t, const proposal *p)
{
    fprintf(out,
            "# Proposed from the names in %s. Check it, then\n"
            "#     iqfoc import LOG --map MAP.toml -o REC.csv\n\n",
            t->path);
    map_print(out, &p->map);
    fputc('\n', out);
    for (int q = 0; q < QUANTITY_COUNT; q++) {
        if (p->map.column[q].there && p->unit_assumed[q]) {
            fprintf(out, "# %s: the log does not say a unit; %s is assumed\n", quantity_key((quantity)q),
                    p->map.column[q].unit->word);
        }
    }
    if (p->map.column[QUANTITY_THETA].there && p->map.column[QUANTITY_THETA].unit->factor == 0.0) {
        fprintf(out, "# theta_e_rad: per_turn is a guess; say how many counts make a turn\n");
    }
    if (p->map.pwm.there) {
        fprintf(out, "# [pwm] frame is the largest count of the first rows; say that of the whole period\n");
    }
    print_missing(out, p);
    if (t->head.has_header) {
        print_unused(out, t, &p->map);
    }
    if (!t->head.has_header) {
        fprintf(out, "# the log has no header: its columns are called \"1\" to \"%zu\"\n", t->columns);
    }
}
