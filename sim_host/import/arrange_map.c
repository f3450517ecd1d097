#include "arrange_map.h"

#include "base/vector.h"

#include <math.h>
#include <string.h>

static int have_of(const import_map *map, quantity first, int count)
{
    int have = 0;
    for (int n = 0; n < count; n++) {
        have += map->column[(int)first + n].there ? 1 : 0;
    }
    return have;
}

arrange_freedom arrange_freedom_of(const import_map *map, const motor *m)
{
    const bool i_phases = have_of(map, QUANTITY_I_A, 3) >= 2;
    const bool u_phases = have_of(map, QUANTITY_U_A, 3) == 3;
    const bool u_vector =
        !u_phases && (have_of(map, QUANTITY_U_D, 2) == 2 || have_of(map, QUANTITY_U_ALPHA, 2) == 2 ||
                      have_of(map, QUANTITY_U_AB, 3) >= 2);
    const bool i_dq = !i_phases && have_of(map, QUANTITY_I_D, 2) == 2;
    const bool u_dq = !u_phases && have_of(map, QUANTITY_U_D, 2) == 2;
    arrange_freedom f = {.current_phases = i_phases,
                         .voltage_phases = u_phases || !u_vector,
                         .angle = map->column[QUANTITY_THETA].there && !i_dq && !u_dq,
                         .derived = VOLTAGE_NONE_DERIVED,
                         .per_angle = map->column[QUANTITY_THETA].mechanical ? 1 : (int)m->pole_pairs};
    for (int x = 0; x < 3; x++) {
        if (i_phases && !map->column[QUANTITY_I_A + x].there) {
            f.derived = x;
        }
    }
    return f;
}

static void negate(map_column *c)
{
    c->scale = -c->scale;
    c->offset = -c->offset;
}

/* Columns of the recording's phases, rearranged. */
static void exchange(import_map *to, const import_map *from, quantity first, const int order[3],
                     const double *sign)
{
    for (int x = 0; x < 3; x++) {
        map_column *c = &to->column[(int)first + x];
        *c = from->column[(int)first + order[x]];
        if (sign != NULL && sign[order[x]] < 0.0) {
            negate(c);
        }
    }
}

static void change_currents(import_map *to, const import_map *map, const arrangement *b)
{
    if (have_of(map, QUANTITY_I_A, 3) >= 2) {
        exchange(to, map, QUANTITY_I_A, b->a.i_from, b->a.i_sign);
        return;
    }
    for (int q = QUANTITY_I_D; q <= QUANTITY_I_BETA && b->a.i_sign[0] < 0.0; q++) {
        negate(&to->column[q]);
    }
}

static void change_commands(import_map *to, const import_map *map, const arrangement *b)
{
    const bool from_duties = have_of(map, QUANTITY_U_A, QUANTITY_D_A - QUANTITY_U_A) < 2;
    exchange(to, map, QUANTITY_U_A, b->a.u_from, NULL);
    exchange(to, map, QUANTITY_D_A, b->a.u_from, NULL);
    if (!b->inverted) {
        return;
    }
    if (from_duties && !to->pwm.there) {
        to->pwm = (map_pwm){true, 1.0, 0.5, false};
    }
    if (to->pwm.there && have_of(map, QUANTITY_D_A, 3) == 3) {
        to->pwm.inverted = !to->pwm.inverted;
    }
    for (int q = QUANTITY_U_A; q < QUANTITY_D_A && !from_duties; q++) {
        negate(&to->column[q]);
    }
}

static void change_angle(import_map *to, const motor *m, const arrangement *b)
{
    map_column *c = &to->column[QUANTITY_THETA];
    if (fabs(b->a.angle_sign) > 1.0) {
        c->mechanical = true;
        to->column[QUANTITY_OMEGA].mechanical = true;
    }
    const double one = c->unit->factor != 0.0 ? c->unit->factor : VEC_TWO_PI / c->per_turn;
    const double factor = c->mechanical ? one * (double)m->pole_pairs : one;
    if (b->a.angle_sign < 0.0) {
        negate(c);
        c->zero = -c->zero;
        negate(&to->column[QUANTITY_OMEGA]);
    }
    if (fabs(b->a.angle_zero) > ARRANGE_ZERO_LEAST) {
        c->zero += round(1000.0 * b->a.angle_zero) / 1000.0 / factor; /* no more than it is good for */
    }
}

static bool differs(const map_column *a, const map_column *b)
{
    return a->there != b->there || strcmp(a->from, b->from) != 0 || a->scale != b->scale ||
           a->offset != b->offset || a->zero != b->zero || a->mechanical != b->mechanical;
}

static void print_lines(FILE *out, const import_map *map, const import_map *changed)
{
    bool any = false;
    for (int q = 0; q < QUANTITY_COUNT; q++) {
        if (!map->column[q].there && !changed->column[q].there) {
            continue;
        }
        if (differs(&map->column[q], &changed->column[q])) {
            fprintf(out, "%s", any ? "" : "[columns]\n");
            any = true;
            if (changed->column[q].there) {
                map_print_column(out, changed, (quantity)q);
            } else {
                fprintf(out, "# without %s\n", quantity_key((quantity)q));
            }
        }
    }
    if (map->pwm.inverted != changed->pwm.inverted) {
        fprintf(out, "[pwm]\ninverted = %s\n", changed->pwm.inverted ? "true" : "false");
    }
    if (map->shift_cycles != changed->shift_cycles) {
        fprintf(out, "[timing]\nshift_cycles = %g\n", changed->shift_cycles);
    }
}

static void print_order(FILE *out, const char *what, const int from[3])
{
    if (from[0] != 0 || from[1] != 1) {
        fprintf(out, "  - %s: phases A, B, C are in the columns of %c, %c, %c\n", what, "ABC"[from[0]],
                "ABC"[from[1]], "ABC"[from[2]]);
    }
}

static void print_signs(FILE *out, const arrangement *b)
{
    int flipped = 0;
    for (int x = 0; x < 3; x++) {
        flipped += b->a.i_sign[x] < 0.0 ? 1 : 0;
    }
    if (flipped == 3) {
        fprintf(out, "  - the currents have the wrong sign\n");
        return;
    }
    for (int x = 0; x < 3; x++) {
        if (b->a.i_sign[x] < 0.0 && x != b->a.i_derived) {
            fprintf(out, "  - the current in the column of phase %c has the wrong sign\n", "ABC"[x]);
        }
    }
}

static bool any_offset(const arrange_result *r)
{
    return r->offset_A[0] != 0.0 || r->offset_A[1] != 0.0 || r->offset_A[2] != 0.0;
}

/* Before columns are exchanged: each entry belongs to its column of the log. */
static void change_offsets(import_map *to, const double offset_A[3])
{
    for (int x = 0; x < 3; x++) {
        map_column *c = &to->column[QUANTITY_I_A + x];
        if (offset_A[x] != 0.0) {
            const double offset = c->offset - offset_A[x] / c->unit->factor;
            const double per_digit = pow(10.0, 3.0 - floor(log10(fabs(offset_A[x] / c->unit->factor))));
            c->offset = round(offset * per_digit) / per_digit; /* no more than it is good for */
        }
    }
}

static void print_offsets(FILE *out, const double offset_A[3])
{
    for (int x = 0; x < 3; x++) {
        if (offset_A[x] != 0.0) {
            fprintf(out, "  - the column of phase %c reads %.3g A at no current\n", "ABC"[x], offset_A[x]);
        }
    }
}

/*
 * A power-invariant transform makes values in d and q sqrt(3/2) times the amplitudes. Against the motor file the flux shows the
 * voltages' scale, and the inductances their ratio to that of the currents.
 */
static void print_scales(FILE *out, const import_map *map, const motor *m, const voltage_fit *fit)
{
    const double invariant = sqrt(1.5);
    const double near = 0.06;
    const bool i_vector = have_of(map, QUANTITY_I_A, 3) < 2;
    const bool u_vector = have_of(map, QUANTITY_U_D, 2) == 2 || have_of(map, QUANTITY_U_ALPHA, 2) == 2;
    const double flux = hypot(fit->x[3], fit->x[4]) / m->psi_f_Wb;
    const double per_d = flux * m->L_d_H / fit->x[1];
    const double per_q = flux * m->L_q_H / fit->x[2];
    const bool i_scaled =
        i_vector && fabs(per_d / invariant - 1.0) < near && fabs(per_q / invariant - 1.0) < near;
    const bool u_scaled = u_vector && fabs(flux / invariant - 1.0) < near;
    if (!(m->psi_f_Wb > 0.0) || !(i_scaled || u_scaled)) {
        return;
    }
    fprintf(
        out,
        "against the motor file, %s %.3g times too large: a power-invariant transform? Then scale = %.6g\n",
        i_scaled && u_scaled ? "currents and voltages are"
        : i_scaled           ? "the currents are"
                             : "the voltages are",
        invariant, 1.0 / invariant);
}

void arrange_print(FILE *out, const import_map *map, const motor *m, const arrange_result *r)
{
    const arrangement *b = &r->best;
    fprintf(out, "as mapped, the voltage equation misses %.3g %% of the voltage%s\n",
            100.0 * sqrt(r->as_mapped.left),
            r->as_mapped.negative ? ", and that with negative inductances" : "");
    if (b->left >= 1.0) {
        fprintf(
            out,
            "no arrangement makes a machine of it: are these the currents and the commands of one drive?\n");
        return;
    }
    if (b->changes == 0 && !any_offset(r)) {
        fprintf(out, "of %zu arrangements none with fewer doubts fits better: keep the map\n", r->tried);
        print_scales(out, map, m, &r->fit);
        return;
    }
    if (!r->as_mapped.negative && b->left >= r->as_mapped.left) {
        fprintf(
            out,
            "of %zu arrangements none fits better (best: %.3g %%): keep the map, and look for another unit, "
            "a scaling or another drive\n",
            r->tried, 100.0 * sqrt(b->left));
        return;
    }
    fprintf(out, "best of %zu arrangements: %.3g %%\n", r->tried, 100.0 * sqrt(b->left));
    print_offsets(out, r->offset_A);
    print_signs(out, b);
    print_order(out, "currents", b->a.i_from);
    print_order(out, "commands", b->a.u_from);
    if (b->inverted) {
        fprintf(out, "  - the commands are inverted\n");
    }
    if (b->polarity_open) {
        fprintf(out,
                "    (without a magnet that turns, reversed currents and inverted commands look alike)\n");
    }
    if (b->a.angle_sign < 0.0) {
        fprintf(out, "  - the angle counts against the phases A, B, C\n");
    }
    if (fabs(b->a.angle_sign) > 1.0) {
        fprintf(out, "  - the angle is the rotor's mechanical one, and the speed with it\n");
    }
    if (fabs(b->a.angle_zero) > ARRANGE_ZERO_LEAST) {
        fprintf(out, "  - the magnet is %.0f degrees from where the angle says\n",
                b->a.angle_zero * 180.0 / VEC_PI);
    }
    if (b->a.late_halves != 0) {
        fprintf(out, "  - a command acts %g cycle%s after its row\n", 0.5 * (double)b->a.late_halves,
                b->a.late_halves == 2 ? "" : "s");
    }
    import_map shifted = *map;
    change_offsets(&shifted, r->offset_A);
    import_map changed = shifted;
    change_currents(&changed, &shifted, b);
    change_commands(&changed, map, b);
    if (changed.column[QUANTITY_THETA].there) {
        change_angle(&changed, m, b);
    }
    changed.shift_cycles += 0.5 * (double)b->a.late_halves;
    fprintf(out, "\nIn the map:\n\n");
    print_lines(out, map, &changed);
    print_scales(out, map, m, &r->fit);
}
