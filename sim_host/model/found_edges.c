/* A cycle's edges one after the other (found_edges.h). */
#include "found_edges.h"

#include <math.h>
#include <string.h>

/* The true voltage of the DC link. */
static double link_of(const averaged_drive *d, const cycle_row *row)
{
    return d->k_u * row->u_dc_V;
}

/* The flux linkage of a current without the fall of the inductances, from the rotor. */
static vec_dq flux_of(const averaged_drive *d, double psi_Wb, vec_ab i, vec_rotor r)
{
    const vec_dq i_dq = vec_to_dq(i, r);
    return (vec_dq){d->L_d_H * i_dq.d + psi_Wb, d->L_q_H * i_dq.q};
}

/*
 * By how much the current half-way between two lies ahead of their mean: it carries the mean of both ends' flux, and the magnet's part of
 * that is another half-way round, as are its harmonics.
 */
static vec_ab half_way(const averaged_drive *d, const cycle_row *row, const cycle_turn *turn, vec_ab first,
                       vec_ab last)
{
    const vec_rotor half = turn->half;
    const double psi_Wb = averaged_drive_magnet(d, row);
    const vec_dq one = flux_of(d, psi_Wb, first, turn->start);
    const vec_dq two = flux_of(d, psi_Wb, last, turn->end);
    /* Seen from the middle, the first flux is half the turn behind, and the last one ahead. */
    const vec_dq flux = {
        0.5 * (half.cos * (one.d + two.d) + half.sin * (one.q - two.q)) - psi_Wb - turn->harmonics_Wb.d,
        0.5 * (half.cos * (one.q + two.q) + half.sin * (two.d - one.d)) - turn->harmonics_Wb.q};
    const vec_ab i = vec_to_ab((vec_dq){flux.d / d->L_d_H, flux.q / d->L_q_H}, turn->middle);
    return (vec_ab){i.alpha - 0.5 * (first.alpha + last.alpha), i.beta - 0.5 * (first.beta + last.beta)};
}

/* A phase's current on the way without the ripple, at a share of the cycle. */
static double on_way(const found_way *way, size_t x, double at)
{
    return way->first[x] + at * (way->last[x] - way->first[x]) + 4.0 * at * (1.0 - at) * way->bow[x];
}

/* The current that a flux in addition makes there. */
static vec_ab current_of_flux(const cycle_turn *turn, double at, vec_ab flux)
{
    double k[3];
    for (size_t n = 0; n < 3; n++) {
        k[n] = turn->per_H[0][n] + at * (turn->per_H[1][n] + at * turn->per_H[2][n]);
    }
    return (vec_ab){k[0] * flux.alpha + k[1] * flux.beta, k[1] * flux.alpha + k[2] * flux.beta};
}

/* Flux of the magnet's harmonics half-way above the mean of both ends, in the middle's frame. */
static vec_dq harmonics_above(const averaged_drive *d, const cycle_turn *turn)
{
    const vec_ab first = averaged_drive_harmonics(d, turn->start);
    const vec_ab last = averaged_drive_harmonics(d, turn->end);
    const vec_ab now = averaged_drive_harmonics(d, turn->middle);
    return vec_to_dq(
        (vec_ab){now.alpha - 0.5 * (first.alpha + last.alpha), now.beta - 0.5 * (first.beta + last.beta)},
        turn->middle);
}

cycle_turn found_turn_of(const averaged_drive *d, const cycle_row *row, vec_rotor start)
{
    const double twice_cos = sqrt(fmax(2.0 + 2.0 * row->cos_turn, 1e-6)); /* of half the turn */
    cycle_turn turn = {.start = start,
                       .end = rotor_turned(start, (vec_rotor){row->cos_turn, row->sin_turn}),
                       .half = {0.5 * twice_cos, row->sin_turn / twice_cos}};
    turn.middle = rotor_turned(start, turn.half);
    if (averaged_drive_has_harmonics(d)) {
        turn.harmonics_Wb = harmonics_above(d, &turn);
    }
    averaged_drive_per_H(d, d->edge_ripple, turn.middle, turn.per_H[0]);
    if (d->L_d_H != d->L_q_H) {
        double k[3][3]; /* at the cycle's start, middle and end */
        averaged_drive_per_H(d, d->edge_ripple, start, k[0]);
        memcpy(k[1], turn.per_H[0], sizeof k[1]);
        averaged_drive_per_H(d, d->edge_ripple, rotor_turned(turn.middle, turn.half), k[2]);
        for (size_t n = 0; n < 3; n++) {
            turn.per_H[0][n] = k[0][n];
            turn.per_H[1][n] = 4.0 * k[1][n] - 3.0 * k[0][n] - k[2][n];
            turn.per_H[2][n] = 2.0 * (k[0][n] + k[2][n]) - 4.0 * k[1][n];
        }
    }
    for (size_t x = 0; x < 3; x++) {
        turn.per_Wb[x] = current_of_flux(&turn, 0.5, vec_phase_axis[x]);
    }
    return turn;
}

found_way found_way_of(const averaged_drive *d, const cycle_row *row, const cycle_turn *turn,
                       const edge_iron *iron, vec_ab first, vec_ab last, vec_ab seen)
{
    found_way way = {.turn = turn, .iron = iron};
    vec_to_phases(first, way.first);
    vec_to_phases(last, way.last);
    vec_to_phases(seen, way.seen);
    vec_to_phases(half_way(d, row, turn, first, last), way.bow);
    return way;
}

/* A leg's current by a flux. */
static double current_by(const found_way *way, size_t x, vec_ab flux)
{
    const vec_ab per_Wb = way->turn->per_Wb[x];
    return per_Wb.alpha * flux.alpha + per_Wb.beta * flux.beta;
}

/* A leg's volt-seconds as a flux, or its voltage as one of the machine. */
static vec_ab of_leg(size_t x, double Vs)
{
    return (vec_ab){2.0 / 3.0 * Vs * vec_phase_axis[x].alpha, 2.0 / 3.0 * Vs * vec_phase_axis[x].beta};
}

static vec_ab sum_of(vec_ab one, vec_ab other)
{
    return (vec_ab){one.alpha + other.alpha, one.beta + other.beta};
}

/* The ripple of all legs where leg x rises (to = 1) or falls (-1), at a share of the cycle, with the iron's part of it. */
static vec_ab ripple_of_edge(const averaged_drive *d, const cycle_row *row, const found_way *way, size_t x,
                             double to, double at)
{
    const double by = to * d->k_u;
    const vec_ab Wb = {by * row->edge_ripple_Wb[x].alpha, by * row->edge_ripple_Wb[x].beta};
    const vec_ab ripple_A = current_of_flux(way->turn, at, Wb);
    if (!way->iron) {
        return ripple_A;
    }
    return sum_of(ripple_A, to > 0.0 ? way->iron->rise_A[x] : way->iron->fall_A[x]);
}

/* What an edge's volt-seconds add to the leg's own current in the iron at once, per flux along its axis. */
static double iron_per_H(const found_way *way)
{
    return way->iron ? way->iron->per_H : 0.0;
}

/* What is left of the iron's current when edge n comes, of that at the edge before it: of leg `now`, and of leg `before`. */
static double iron_left(const edge_iron *iron, size_t n, size_t before, size_t now)
{
    const double *left = iron->left;
    if (n == 0) {
        return 0.0;
    }
    return n < 3    ? left[now] / left[before]
           : n == 3 ? iron->fade / (left[now] * left[before])
                    : left[before] / left[now];
}

/* The legs in the order in which they rise; they fall in the opposite one. */
static void order_of(const double rise[3], size_t order[3])
{
    const size_t one = rise[1] < rise[0] ? 1 : 0; /* ahead of the first */
    const size_t two = rise[2] < rise[0] ? 1 : 0;
    const size_t last = rise[2] < rise[1] ? 1 : 0; /* the last ahead of the second */
    order[one + two] = 0;
    order[1 - one + last] = 1;
    order[2 - two - last] = 2;
}

/* What an edge finds and takes. */
typedef struct edge {
    size_t leg;
    double at;       /* share of the period */
    vec_ab ripple_A; /* of all legs there */
    /*
     * What decides, as a share of the current from which on a loss is whole: half a dead time on, and when a compensation has moved the
     * edge. Without what the edges before it have changed, and how that adds to it.
     */
    double decides;
    vec_ab per_Wb;
    double even_V, by_sign_V;   /* what it takes in any case, and with the sign that it finds, */
    vec_ab even_Wb, by_sign_Wb; /* and what these change */
    vec_ab before_Wb;           /* what those before it have changed */
} edge;

enum { EDGES = 6 }; /* the three rises lie before the three falls */

/* One period of the carrier. */
typedef struct period {
    const averaged_drive *d;
    const cycle_row *row;
    const found_way *way;
    double start, share;           /* of the cycle */
    double length_s, per_cycle_s;  /* of the period; 1 over the cycle's */
    double decay;                  /* of a flux over the cycle, as a share */
    double link_V, late_V, late_s; /* what an edge takes at most; the dead time, both edges together */
    double moved_V[3];             /* each edge, by the compensation */
    bool far[3];                   /* legs that keep their currents' signs */
    double per_whole_A[3];         /* 1 over the current from which on a loss is whole */
    double own_per_Vs[3];          /* of a leg's current by its own volt-seconds */
    double through_V;              /* what conducting devices take: */
    double taken[3];               /* of each leg that share, */
    double through_A[3];           /* by which it then changes the currents until the period's end */
    vec_ab changed_Wb;             /* by the edges */
} period;

/* How much more of a loss at a share of the period is there at the cycle's end than of one that is spread over the cycle. */
static double undecayed(const period *p, double at)
{
    return 1.0 + p->decay * (p->start + at * p->share - 0.5);
}

/* A leg's current without ripple and lost edges, at a share of the period. */
static double smooth_at(const period *p, size_t x, double at)
{
    return on_way(p->way, x, p->start + at * p->share) + at * p->through_A[x];
}

/* An edge and what it takes; `later_A` of the current decides in addition. */
static void put_edge(const period *p, size_t x, double to, double at, double later_A, edge *e)
{
    const cycle_row *row = p->row;
    const double per_whole_A = p->per_whole_A[x];
    const double none = to > 0.0 ? row->no_rise[x] : row->no_fall[x];
    e->leg = x;
    e->at = at;
    e->ripple_A = ripple_of_edge(p->d, row, p->way, x, to, p->start + at * p->share);
    e->decides = (smooth_at(p, x, at) + vec_phase(e->ripple_A, (int)x) + later_A) * per_whole_A;
    e->per_Wb =
        (vec_ab){p->way->turn->per_Wb[x].alpha * per_whole_A, p->way->turn->per_Wb[x].beta * per_whole_A};
    e->by_sign_V = 0.5 * p->late_V * (1.0 - none);
    e->even_V = to * e->by_sign_V - p->moved_V[x];
    e->by_sign_Wb = of_leg(x, -e->by_sign_V * p->length_s);
    e->even_Wb = of_leg(x, -e->even_V * p->length_s);
}

/* The edges in their order. Between its rise and its fall the others' states are as before it: they fall in the opposite order. */
static void find_edges(const period *p, edge edges[EDGES])
{
    const found_way *way = p->way;
    const double s_per_V = p->length_s / p->link_V;
    size_t order[3];
    vec_ab u_V = {0.0, 0.0}; /* above the period's mean */
    vec_ab whole_V = {0.0, 0.0};
    order_of(p->row->rise, order);
    for (size_t x = 0; x < 3; x++) {
        u_V = sum_of(u_V, of_leg(x, (2.0 * p->row->rise[x] - 1.0) * p->link_V));
    }
    for (size_t n = 0; n < 3; n++) {
        const size_t x = order[n];
        const double low_A_s = current_by(way, x, u_V) + (way->last[x] - way->first[x]) * p->per_cycle_s +
                               iron_per_H(way) * vec_phase(whole_V, (int)x);
        const double high_A_s = low_A_s + p->own_per_Vs[x] * p->link_V;
        const double moved_s = p->moved_V[x] * s_per_V;
        const double held_A = 0.5 * (low_A_s + high_A_s) * p->late_s;
        put_edge(p, x, 1.0, p->row->rise[x], held_A - low_A_s * moved_s, &edges[n]);
        put_edge(p, x, -1.0, 1.0 - p->row->rise[x], held_A + high_A_s * moved_s, &edges[EDGES - 1 - n]);
        u_V = sum_of(u_V, of_leg(x, p->link_V));
        whole_V = sum_of(whole_V, of_leg(x, p->link_V));
    }
}

/* What each leg loses over the cycle, in sum as one that acts evenly. */
typedef struct leg_losses {
    double sum_V[3];
    edge_losses each;
} leg_losses;

/* Adds what the edges take, one after the other. */
static void lose_at_edges(period *p, edge edges[EDGES], leg_losses *lost)
{
    const edge_iron *iron = p->way->iron;
    vec_ab changed_Wb = {0.0, 0.0};
    vec_ab in_iron_Wb = {0.0, 0.0}; /* the same, as far as it has not faded */
    for (size_t n = 0; n < EDGES; n++) {
        edge *e = &edges[n];
        double found = e->decides + e->per_Wb.alpha * changed_Wb.alpha + e->per_Wb.beta * changed_Wb.beta;
        if (iron) {
            const double left = iron_left(iron, n, edges[n > 0 ? n - 1 : 0].leg, e->leg);
            in_iron_Wb = (vec_ab){left * in_iron_Wb.alpha, left * in_iron_Wb.beta};
            found += iron->per_H * vec_phase(in_iron_Wb, (int)e->leg) * p->per_whole_A[e->leg];
        }
        const double sign = averaged_drive_edge(p->d->edge, found);
        const vec_ab by_edge_Wb = {e->even_Wb.alpha + sign * e->by_sign_Wb.alpha,
                                   e->even_Wb.beta + sign * e->by_sign_Wb.beta};
        const double takes_V = e->even_V + sign * e->by_sign_V;
        lost->sum_V[e->leg] += takes_V * undecayed(p, e->at);
        *(n < 3 ? &lost->each.rise_V[e->leg] : &lost->each.fall_V[e->leg]) += takes_V;
        e->before_Wb = changed_Wb;
        changed_Wb = sum_of(changed_Wb, by_edge_Wb);
        in_iron_Wb = sum_of(in_iron_Wb, by_edge_Wb);
    }
    p->changed_Wb = changed_Wb;
}

/*
 * What the devices' drop is taken to change of each leg's current over the period: all, by the sign at its start, of a current that keeps
 * it. Without leaps, or a fit takes them for information.
 */
static void find_through(period *p)
{
    const double Vs = p->through_V * p->length_s;
    vec_ab changed_Wb = {0.0, 0.0};
    for (size_t x = 0; x < 3; x++) {
        const double drop_A = p->own_per_Vs[x] * Vs;
        const double start_A = on_way(p->way, x, p->start);
        p->taken[x] = drop_A > 0.0 ? averaged_drive_edge(EDGE_CLIPPED, start_A / drop_A) : 0.0;
        changed_Wb = sum_of(changed_Wb, of_leg(x, -Vs * p->taken[x]));
    }
    for (size_t x = 0; x < 3; x++) {
        p->through_A[x] = current_by(p->way, x, changed_Wb);
    }
}

/*
 * The mean sign of a current over a stretch that all else moves, and that the devices' whole drop would move by `drop` against its sign.
 */
static double mean_sign(double from_A, double move_A, double drop_A)
{
    const double sign = from_A > 0.0 ? 1.0 : from_A < 0.0 ? -1.0 : 0.0;
    const double net_A = move_A - sign * drop_A;
    if (sign * (from_A + net_A) > 0.0) {
        return sign;
    }
    const double until = sign != 0.0 ? -from_A / net_A : 0.0; /* it reaches zero */
    const double after = fabs(move_A) <= drop_A && drop_A > 0.0 ? move_A / drop_A : copysign(1.0, move_A);
    return until * sign + (1.0 - until) * after;
}

static void add_through(const period *p, size_t x, double takes_V, double at, leg_losses *lost)
{
    lost->sum_V[x] += takes_V * undecayed(p, at);
    lost->each.rise_V[x] += 0.5 * takes_V;
    lost->each.fall_V[x] += 0.5 * takes_V;
}

/* Adds what leg x' conducting devices take, from edge to edge. */
static void lose_through(const period *p, const edge edges[EDGES], size_t x, leg_losses *lost)
{
    const double drop_A = p->own_per_Vs[x] * p->through_V * p->length_s;
    const double taken_A = drop_A * p->taken[x]; /* in the currents below, by the period's end */
    const double end_A = smooth_at(p, x, 1.0) + current_by(p->way, x, p->changed_Wb);
    double i_A = on_way(p->way, x, p->start);
    double at = 0.0;
    double own_A = 0.0; /* in place of what is taken */
    for (size_t n = 0; n <= EDGES; n++) {
        const edge *e = &edges[n];
        const double next = n < EDGES ? e->at : 1.0;
        const double next_A = n < EDGES ? smooth_at(p, x, next) + vec_phase(e->ripple_A, (int)x) +
                                              current_by(p->way, x, e->before_Wb)
                                        : end_A;
        const double share = next - at;
        const double sign =
            mean_sign(i_A + at * taken_A - own_A, next_A - i_A + share * taken_A, share * drop_A);
        own_A += sign * share * drop_A;
        add_through(p, x, sign * share * p->through_V, at + 0.5 * share, lost);
        at = next;
        i_A = next_A;
    }
}

/* Adds what each leg loses over one period. */
static void lose(period *p, leg_losses *lost)
{
    edge edges[EDGES];
    if (p->through_V > 0.0) {
        find_through(p);
    }
    find_edges(p, edges);
    lose_at_edges(p, edges, lost);
    for (size_t x = 0; x < 3 && p->through_V > 0.0; x++) {
        if (p->far[x]) {
            add_through(p, x, p->taken[x] * p->through_V, 0.5, lost);
        } else {
            lose_through(p, edges, x, lost);
        }
    }
}

/*
 * Whether a leg's current is so far from zero that it keeps its sign, and every edge finds a whole loss: its ends lie farther than ripple
 * and bow, and what all that is lost changes, can take it.
 */
static bool is_far(const period *p, size_t x, double ripple_A, double per_H)
{
    const found_way *way = p->way;
    const double moved_V = fmax(fabs(p->moved_V[0]), fmax(fabs(p->moved_V[1]), fabs(p->moved_V[2])));
    const double lost_V = 3.0 * fabs(p->late_V) + 5.0 * moved_V + 2.0 * p->through_V;
    const double iron_A = way->iron ? way->iron->most_A + way->iron->per_H * lost_V * p->length_s : 0.0;
    const double far_A =
        ripple_A + fabs(way->bow[x]) + per_H * lost_V * p->length_s + p->d->i_knee_A + iron_A;
    return way->first[x] * way->last[x] > 0.0 && fabs(way->first[x]) > far_A && fabs(way->last[x]) > far_A;
}

/* What the legs lose whose currents are all far from zero. */
static void lose_far(const period *p, double lost[3], edge_losses *each)
{
    for (size_t x = 0; x < 3; x++) {
        const double sign = p->way->first[x] > 0.0 ? 1.0 : -1.0;
        const double at = 0.5 + sign * (p->row->rise[x] - 0.5);
        const double whole = 1.0 - (sign > 0.0 ? p->row->no_rise[x] : p->row->no_fall[x]);
        const double late_V = p->late_V * whole * (1.0 + p->decay * p->share * (at - 0.5));
        lost[x] = sign * (late_V + p->through_V) - 2.0 * p->moved_V[x];
        each->rise_V[x] = each->fall_V[x] = 0.5 * sign * p->through_V - p->moved_V[x];
        *(sign > 0.0 ? &each->rise_V[x] : &each->fall_V[x]) += sign * p->late_V * whole;
    }
}

void found_edges_lost(const averaged_drive *d, const cycle_row *row, const found_way *way, double T_s,
                      double lost[3], edge_losses *each)
{
    const size_t periods = row->periods > 1 ? row->periods : 1;
    const double share = 1.0 / (double)periods;
    const double all_V = d->v_dead_V + d->compensation_V;
    const double through_V = all_V > 0.0 ? d->conduction * all_V : 0.0;
    const double late_V = all_V - through_V;
    const double link_V = link_of(d, row);
    const double per_L_d = 1.0 / d->L_d_H;
    const double per_L_q = 1.0 / d->L_q_H;
    const double per_H = d->edge_ripple * fmax(per_L_d, per_L_q);
    period p = {.d = d,
                .row = row,
                .way = way,
                .share = share,
                .length_s = T_s * share,
                .per_cycle_s = 1.0 / T_s,
                .decay = 0.5 * d->R_ohm * (per_L_d + per_L_q) * T_s,
                .link_V = link_V,
                .late_V = late_V,
                .late_s = late_V * T_s * share / link_V,
                .through_V = through_V};
    double ripple_Wb = 0.0;
    for (size_t x = 0; x < 3; x++) {
        /* No edge moves beyond the valley or the peak. */
        const double wanted = 0.5 * averaged_drive_compensation(d, way->seen[x]);
        const double earliest = (row->rise[x] - 0.5) * link_V;
        const double latest = row->rise[x] * link_V;
        p.moved_V[x] = wanted < earliest ? earliest : wanted > latest ? latest : wanted;
        ripple_Wb = fmax(ripple_Wb, fabs(row->edge_ripple_Wb[x].alpha) + fabs(row->edge_ripple_Wb[x].beta));
    }
    for (size_t x = 0; x < 3; x++) {
        p.far[x] = d->edge == EDGE_CLIPPED && is_far(&p, x, per_H * d->k_u * ripple_Wb, per_H);
    }
    if (p.far[0] && p.far[1] && p.far[2]) {
        lose_far(&p, lost, each);
        return;
    }
    leg_losses all = {.sum_V = {0.0}};
    for (size_t x = 0; x < 3; x++) {
        p.own_per_Vs[x] = current_by(way, x, of_leg(x, 1.0)) + 2.0 / 3.0 * iron_per_H(way);
        const double reach_A = 0.5 * p.own_per_Vs[x] * link_V * p.late_s;
        p.per_whole_A[x] = 1.0 / sqrt(reach_A * reach_A + d->i_knee_A * d->i_knee_A);
    }
    for (size_t n = 0; n < periods; n++) {
        p.start = (double)n * share;
        lose(&p, &all);
    }
    for (size_t x = 0; x < 3; x++) {
        lost[x] = share * all.sum_V[x];
        each->rise_V[x] = share * all.each.rise_V[x];
        each->fall_V[x] = share * all.each.fall_V[x];
    }
}

edge_losses found_edges_each(const averaged_drive *d, const cycle_row *row, const cycle_turn *turn,
                             const edge_iron *iron, vec_ab first, vec_ab last)
{
    edge_losses each = {.rise_V = {0.0}};
    if (!averaged_drive_loses(d)) {
        return each;
    }
    cycle_turn found;
    if (!turn) {
        found = found_turn_of(d, row, averaged_drive_rotor(d, row));
        turn = &found;
    }
    /* The last current has what was lost, which a way is without. */
    double lost[3];
    found_way way = found_way_of(d, row, turn, iron, first, last, first);
    found_edges_lost(d, row, &way, row->T_s, lost, &each);
    const vec_ab V = vec_from_phases(lost);
    const vec_ab more = current_of_flux(turn, 1.0, (vec_ab){row->T_s * V.alpha, row->T_s * V.beta});
    way = found_way_of(d, row, turn, iron, first, sum_of(last, more), first);
    found_edges_lost(d, row, &way, row->T_s, lost, &each);
    return each;
}
