#include "plant_effect.h"
#include "../base/number.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#define KEYS_MAX 5

/* What a key's typical value is a multiple of. */
typedef enum relative_to {
    ABSOLUTE,
    OF_ITSELF, /* of the value that stands there */
    OF_RATED,  /* rated peak current */
    OF_CYCLE,
    OF_LINK,
    OF_MAGNET,
    OF_RESISTANCE
} relative_to;

typedef enum key_kind { REAL, WHOLE, FLAG, BOTH_INDUCTANCES, MEAN_INDUCTANCE } key_kind;

typedef struct effect_key {
    const char *name;
    const char *unit;
    key_kind kind;
    size_t offset; /* into plant_config */
    double typical;
    relative_to of;
} effect_key;

typedef struct effect {
    const char *id;
    const char *does;
    effect_key key[KEYS_MAX]; /* the first without a name ends them */
} effect;

#define AT(field) offsetof(plant_config, field)

static const effect effects[] = {
    {"resistance", "winding resistance", {{"R", "ohm", REAL, AT(machine.R_ohm), 1.3, OF_ITSELF}}},
    {"inductance",
     "stator inductance, both axes alike",
     {{"L", "H", BOTH_INDUCTANCES, AT(machine.L_d_H), 0.85, OF_ITSELF}}},
    {"flux_linkage", "magnet flux linkage", {{"psi_f", "Wb", REAL, AT(machine.psi_f_Wb), 0.93, OF_ITSELF}}},
    {"saliency",
     "unequal inductances",
     {{"L_d", "H", REAL, AT(machine.L_d_H), 0.85, OF_ITSELF},
      {"L_q", "H", REAL, AT(machine.L_q_H), 1.15, OF_ITSELF}}},
    {"saturation",
     "flux / current = L_0 / (1 + (|i|/I_sat)^2), the axes in their ratio",
     {{"L_0", "H", MEAN_INDUCTANCE, AT(machine.L_d_H), 1.0, OF_ITSELF},
      {"I_sat", "A", REAL, AT(machine.I_sat_A), 2.0, OF_RATED}}},
    {"dead_time",
     "late switching-on, and the devices' drops",
     {{"t_dead", "s", REAL, AT(inverter.t_dead_s), 0.01, OF_CYCLE},
      {"v_switch", "V", REAL, AT(inverter.v_switch_V), 0.0, ABSOLUTE},
      {"v_diode", "V", REAL, AT(inverter.v_diode_V), 0.0, ABSOLUTE},
      {"r_on", "ohm", REAL, AT(inverter.r_on_ohm), 0.0, ABSOLUTE}}},
    {"voltage_gain",
     "DC link measured wrong: applied = k_u * recorded",
     {{"k_u", "1", REAL, AT(inverter.k_u), 0.97, ABSOLUTE}}},
    {"current_offset",
     "measured = gain * true + offset",
     {{"o_a", "A", REAL, AT(sensors.current_offset_A[0]), 0.02, OF_RATED},
      {"o_b", "A", REAL, AT(sensors.current_offset_A[1]), 0.0, ABSOLUTE},
      {"o_c", "A", REAL, AT(sensors.current_offset_A[2]), -0.01, OF_RATED}}},
    {"current_gain",
     "measured = gain * true + offset",
     {{"g_a", "1", REAL, AT(sensors.current_gain[0]), 1.03, ABSOLUTE},
      {"g_b", "1", REAL, AT(sensors.current_gain[1]), 1.0, ABSOLUTE},
      {"g_c", "1", REAL, AT(sensors.current_gain[2]), 0.98, ABSOLUTE}}},
    {"current_noise",
     "standard deviation of each sample",
     {{"sigma", "A", REAL, AT(sensors.current_noise_A), 0.002, OF_RATED}}},
    {"current_quantisation",
     "converter over -full_scale .. +full_scale",
     {{"bits", "1", WHOLE, AT(sensors.current_bits), 12.0, ABSOLUTE},
      {"full_scale", "A", REAL, AT(sensors.current_full_scale_A), 2.0, OF_RATED}}},
    {"current_bandwidth",
     "first-order low-pass",
     {{"f", "Hz", REAL, AT(sensors.current_bandwidth_Hz), 50e3, ABSOLUTE}}},
    {"angle_offset",
     "recorded angle = true + theta_0",
     {{"theta_0", "rad", REAL, AT(sensors.theta_0_rad), 0.05, ABSOLUTE}}},
    {"angle_harmonic",
     "recorded angle = true + amplitude cos(order theta_mech + phase)",
     {{"order", "1", REAL, AT(sensors.harmonic_order), 1.0, ABSOLUTE},
      {"amplitude", "rad", REAL, AT(sensors.harmonic_amplitude_rad), 0.03, ABSOLUTE},
      {"phase", "rad", REAL, AT(sensors.harmonic_phase_rad), 0.0, ABSOLUTE}}},
    {"angle_delay",
     "recorded angle = true at t + t_delay",
     {{"t_delay", "s", REAL, AT(sensors.t_delay_s), 0.05, OF_CYCLE}}},
    {"angle_noise",
     "standard deviation, electrical",
     {{"sigma", "rad", REAL, AT(sensors.angle_noise_rad), 0.001, ABSOLUTE}}},
    {"voltage_delay",
     "duties act so many cycles late",
     {{"cycles", "1", WHOLE, AT(inverter.delay_cycles), 1.0, ABSOLUTE}}},
    {"emf_harmonics",
     "5th and 7th harmonic of the magnet's flux",
     {{"psi_5", "Wb", REAL, AT(machine.psi_5_Wb), 0.006, OF_MAGNET},
      {"psi_7", "Wb", REAL, AT(machine.psi_7_Wb), 0.003, OF_MAGNET}}},
    {"phase_asymmetry",
     "resistance added to a phase",
     {{"dR_a", "ohm", REAL, AT(machine.dR_ohm[0]), 0.3, OF_RESISTANCE},
      {"dR_b", "ohm", REAL, AT(machine.dR_ohm[1]), 0.0, ABSOLUTE},
      {"dR_c", "ohm", REAL, AT(machine.dR_ohm[2]), 0.0, ABSOLUTE}}},
    {"u_dc_ripple",
     "sine on the DC link, in the measured link too (logged=1) or not",
     {{"amplitude", "V", REAL, AT(inverter.ripple_V), 0.03, OF_LINK},
      {"frequency", "Hz", REAL, AT(inverter.ripple_Hz), 300.0, ABSOLUTE},
      {"logged", "1", FLAG, AT(inverter.ripple_logged), 1.0, ABSOLUTE}}},
    {"ripple",
     "sine on the DC link that the measurement does not show",
     {{"amplitude", "V", REAL, AT(inverter.ripple_V), 0.03, OF_LINK},
      {"frequency", "Hz", REAL, AT(inverter.ripple_Hz), 300.0, ABSOLUTE}}},
    {"iron_loss",
     "loss branch beside the flux, with a time constant",
     {{"R_fe", "ohm", REAL, AT(machine.R_fe_ohm), 200.0, OF_RESISTANCE},
      {"tau_fe", "s", REAL, AT(machine.tau_fe_s), 50e-6, ABSOLUTE}}},
    {"glitch",
     "a PWM update missed now and then: the last duties stay",
     {{"probability", "1", REAL, AT(inverter.glitch_probability), 0.002, ABSOLUTE}}},
    {"loose_sensor",
     "dropouts of one current channel: it reads gain * value + step",
     {{"probability", "1", REAL, AT(sensors.loose_probability), 0.001, ABSOLUTE},
      {"channel", "1", WHOLE, AT(sensors.loose_channel), 0.0, ABSOLUTE},
      {"samples", "1", REAL, AT(sensors.loose_samples), 3.0, ABSOLUTE},
      {"gain", "1", REAL, AT(sensors.loose_gain), 0.0, ABSOLUTE},
      {"step", "A", REAL, AT(sensors.loose_step_A), 0.0, ABSOLUTE}}},
};

enum { EFFECTS = (int)(sizeof effects / sizeof effects[0]) };

const char *plant_effect_id(int k)
{
    return k >= 0 && k < EFFECTS ? effects[k].id : NULL;
}

static int key_count(const effect *f)
{
    int n = 0;
    while (n < KEYS_MAX && f->key[n].name != NULL) {
        n++;
    }
    return n;
}

static double typical_value(const plant_config *c, const effect_key *key)
{
    double unit = 1.0;
    switch (key->of) {
    case ABSOLUTE:
        break;
    case OF_ITSELF:
        if (key->kind == MEAN_INDUCTANCE || key->kind == BOTH_INDUCTANCES) {
            unit = 0.5 * (c->machine.L_d_H + c->machine.L_q_H);
        } else {
            memcpy(&unit, (const char *)c + key->offset, sizeof unit);
        }
        break;
    case OF_RATED:
        unit = c->I_scale_A;
        break;
    case OF_CYCLE:
        unit = c->T_s;
        break;
    case OF_LINK:
        unit = c->inverter.u_dc_V;
        break;
    case OF_MAGNET:
        unit = c->machine.psi_f_Wb;
        break;
    case OF_RESISTANCE:
        unit = c->machine.R_ohm;
        break;
    }
    return key->typical * unit;
}

/* False: the value is none of the key's kind. */
static bool set_key(plant_config *c, const effect_key *key, double value)
{
    const bool whole = value == floor(value) && fabs(value) < 1e9;
    char *field = (char *)c + key->offset;
    switch (key->kind) {
    case REAL:
        memcpy(field, &value, sizeof value);
        return true;
    case WHOLE: {
        const int number = whole ? (int)value : 0;
        memcpy(field, &number, sizeof number);
        return whole;
    }
    case FLAG: {
        const bool flag = value == 1.0;
        memcpy(field, &flag, sizeof flag);
        return value == 0.0 || value == 1.0;
    }
    case BOTH_INDUCTANCES:
        c->machine.L_d_H = value;
        c->machine.L_q_H = value;
        return true;
    case MEAN_INDUCTANCE: {
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
    for (int k = 0; k < EFFECTS; k++) {
        if (strlen(effects[k].id) == length && strncmp(effects[k].id, text, length) == 0) {
            return &effects[k];
        }
    }
    return NULL;
}

/* One "key=value" of the text. */
static bool take_setting(plant_config *c, const effect *f, const char *text, const char *setting,
                         size_t length, bool seen[KEYS_MAX], error *e)
{
    char known[200];
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
            const char *expected = f->key[k].kind == FLAG ? "0 or 1" : "a whole number";
            return error_input(e, NULL, 0, 0, "effect \"%s\": %s is %g, expected %s", text, f->key[k].name,
                               value, expected);
        }
        return true;
    }
    return error_input(e, NULL, 0, 0, "effect \"%s\": unknown key \"%.*s\", expected one of %s", text,
                       (int)name, setting, known);
}

bool plant_effect_apply(plant_config *c, const char *text, error *e)
{
    const size_t id_length = strcspn(text, ":");
    const effect *f = find(text, id_length);
    if (f == NULL) {
        return error_input(e, NULL, 0, 0,
                           "effect \"%s\": unknown id \"%.*s\"; `iqfoc simulate --help` lists them", text,
                           (int)id_length, text);
    }
    plant_config changed = *c;
    if (f->key[0].offset == AT(inverter.ripple_V)) {
        changed.inverter.ripple_logged = false;
    }
    if (text[id_length] == '\0') {
        for (int k = 0; k < key_count(f); k++) {
            (void)set_key(&changed, &f->key[k], typical_value(c, &f->key[k]));
        }
    } else {
        bool seen[KEYS_MAX] = {false};
        const char *setting = text + id_length;
        while (*setting != '\0') {
            setting++; /* past ':' or ',' */
            const size_t length = strcspn(setting, ",");
            if (!take_setting(&changed, f, text, setting, length, seen, e)) {
                return false;
            }
            setting += length;
        }
    }
    error wrong = {0};
    if (!plant_config_check(&changed, &wrong)) {
        return error_input(e, NULL, 0, 0, "effect \"%s\": %s", text, wrong.text);
    }
    *c = changed;
    return true;
}

void plant_effect_list(FILE *stream)
{
    for (int k = 0; k < EFFECTS; k++) {
        char keys[200];
        name_keys(&effects[k], keys, sizeof keys);
        (void)fprintf(stream, "  %-21s %s: %s\n", effects[k].id, effects[k].does, keys);
    }
}
