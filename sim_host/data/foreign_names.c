#include "foreign_names.h"

#include <ctype.h>
#include <string.h>

enum { NAME_MOST = 64 };

typedef struct known {
    const char *name; /* small letters and digits only */
    foreign_name is;
} known;

/*
 * Plain spellings first; then, by their public documentation, VESC Tool's real-time log, ODrive's and moteus'
 * property names, SimpleFOC's monitor, motulator's signals.
 */
static const known names[] = {
    {"t", {"t_s", NULL, false}},
    {"ts", {"t_s", NULL, false}},
    {"time", {"t_s", NULL, false}},
    {"timestamp", {"t_s", NULL, false}},
    {"zeit", {"t_s", NULL, false}},
    {"run", {"run", NULL, false}},
    {"segment", {"run", NULL, false}},
    {"burst", {"run", NULL, false}},
    {"ia", {"i_a_A", NULL, false}},
    {"iu", {"i_a_A", NULL, false}},
    {"i1", {"i_a_A", NULL, false}},
    {"ipha", {"i_a_A", NULL, false}},
    {"iphasea", {"i_a_A", NULL, false}},
    {"currenta", {"i_a_A", NULL, false}},
    {"phasecurrenta", {"i_a_A", NULL, false}},
    {"ib", {"i_b_A", NULL, false}},
    {"iv", {"i_b_A", NULL, false}},
    {"i2", {"i_b_A", NULL, false}},
    {"iphb", {"i_b_A", NULL, false}},
    {"iphaseb", {"i_b_A", NULL, false}},
    {"currentb", {"i_b_A", NULL, false}},
    {"phasecurrentb", {"i_b_A", NULL, false}},
    {"ic", {"i_c_A", NULL, false}},
    {"iw", {"i_c_A", NULL, false}},
    {"i3", {"i_c_A", NULL, false}},
    {"iphc", {"i_c_A", NULL, false}},
    {"iphasec", {"i_c_A", NULL, false}},
    {"currentc", {"i_c_A", NULL, false}},
    {"phasecurrentc", {"i_c_A", NULL, false}},
    {"id", {"i_d_A", NULL, false}},
    {"isd", {"i_d_A", NULL, false}},
    {"idmeas", {"i_d_A", NULL, false}},
    {"idfbk", {"i_d_A", NULL, false}},
    {"iq", {"i_q_A", NULL, false}},
    {"isq", {"i_q_A", NULL, false}},
    {"iqmeas", {"i_q_A", NULL, false}},
    {"iqfbk", {"i_q_A", NULL, false}},
    {"ialpha", {"i_alpha_A", NULL, false}},
    {"isalpha", {"i_alpha_A", NULL, false}},
    {"ialfa", {"i_alpha_A", NULL, false}},
    {"ibeta", {"i_beta_A", NULL, false}},
    {"isbeta", {"i_beta_A", NULL, false}},
    {"ua", {"u_a_V", NULL, false}},
    {"va", {"u_a_V", NULL, false}},
    {"ub", {"u_b_V", NULL, false}},
    {"vb", {"u_b_V", NULL, false}},
    {"uc", {"u_c_V", NULL, false}},
    {"vc", {"u_c_V", NULL, false}},
    {"ud", {"u_d_V", NULL, false}},
    {"vd", {"u_d_V", NULL, false}},
    {"usd", {"u_d_V", NULL, false}},
    {"uq", {"u_q_V", NULL, false}},
    {"vq", {"u_q_V", NULL, false}},
    {"usq", {"u_q_V", NULL, false}},
    {"ualpha", {"u_alpha_V", NULL, false}},
    {"valpha", {"u_alpha_V", NULL, false}},
    {"ubeta", {"u_beta_V", NULL, false}},
    {"vbeta", {"u_beta_V", NULL, false}},
    {"uab", {"u_ab_V", NULL, false}},
    {"vab", {"u_ab_V", NULL, false}},
    {"ubc", {"u_bc_V", NULL, false}},
    {"vbc", {"u_bc_V", NULL, false}},
    {"uca", {"u_ca_V", NULL, false}},
    {"vca", {"u_ca_V", NULL, false}},
    {"da", {"d_a", NULL, false}},
    {"db", {"d_b", NULL, false}},
    {"dc", {"d_c", NULL, false}},
    {"dutya", {"d_a", NULL, false}},
    {"dutyb", {"d_b", NULL, false}},
    {"dutyc", {"d_c", NULL, false}},
    {"ccr1", {"d_a", NULL, false}},
    {"ccr2", {"d_b", NULL, false}},
    {"ccr3", {"d_c", NULL, false}},
    {"cmpa", {"d_a", NULL, false}},
    {"cmpb", {"d_b", NULL, false}},
    {"cmpc", {"d_c", NULL, false}},
    {"pwma", {"d_a", NULL, false}},
    {"pwmb", {"d_b", NULL, false}},
    {"pwmc", {"d_c", NULL, false}},
    {"udc", {"u_dc_V", NULL, false}},
    {"vdc", {"u_dc_V", NULL, false}},
    {"vbus", {"u_dc_V", NULL, false}},
    {"udcbus", {"u_dc_V", NULL, false}},
    {"vdcbus", {"u_dc_V", NULL, false}},
    {"dclink", {"u_dc_V", NULL, false}},
    {"theta", {"theta_e_rad", NULL, false}},
    {"thetae", {"theta_e_rad", NULL, false}},
    {"thetael", {"theta_e_rad", NULL, false}},
    {"angle", {"theta_e_rad", NULL, false}},
    {"elangle", {"theta_e_rad", NULL, false}},
    {"electricalangle", {"theta_e_rad", NULL, false}},
    {"phi", {"theta_e_rad", NULL, false}},
    {"phiel", {"theta_e_rad", NULL, false}},
    {"enc", {"theta_e_rad", "count", true}},
    {"encoder", {"theta_e_rad", "count", true}},
    {"encodercount", {"theta_e_rad", "count", true}},
    {"encodercounts", {"theta_e_rad", "count", true}},
    {"thetam", {"theta_e_rad", NULL, true}},
    {"thetamech", {"theta_e_rad", NULL, true}},
    {"mechangle", {"theta_e_rad", NULL, true}},
    {"omega", {"omega_e_rad_s", NULL, false}},
    {"omegae", {"omega_e_rad_s", NULL, false}},
    {"we", {"omega_e_rad_s", NULL, false}},
    {"wel", {"omega_e_rad_s", NULL, false}},
    {"omegam", {"omega_e_rad_s", NULL, true}},
    {"n", {"omega_e_rad_s", "rpm", true}},
    {"rpm", {"omega_e_rad_s", "rpm", true}},
    {"speed", {"omega_e_rad_s", "rpm", true}},
    {"speedrpm", {"omega_e_rad_s", "rpm", true}},
    {"drehzahl", {"omega_e_rad_s", "rpm", true}},
    {"temp", {"temp_C", NULL, false}},
    {"tempmotor", {"temp_C", NULL, false}},
    /* German and French; letters with accents are left out of a name before it is compared. */
    {"stroma", {"i_a_A", NULL, false}},
    {"stromb", {"i_b_A", NULL, false}},
    {"stromc", {"i_c_A", NULL, false}},
    {"couranta", {"i_a_A", NULL, false}},
    {"courantb", {"i_b_A", NULL, false}},
    {"courantc", {"i_c_A", NULL, false}},
    {"spannunga", {"u_a_V", NULL, false}},
    {"spannungb", {"u_b_V", NULL, false}},
    {"spannungc", {"u_c_V", NULL, false}},
    {"tensiona", {"u_a_V", NULL, false}},
    {"tensionb", {"u_b_V", NULL, false}},
    {"tensionc", {"u_c_V", NULL, false}},
    {"tastgrada", {"d_a", NULL, false}},
    {"tastgradb", {"d_b", NULL, false}},
    {"tastgradc", {"d_c", NULL, false}},
    {"rapportcycliquea", {"d_a", NULL, false}},
    {"rapportcycliqueb", {"d_b", NULL, false}},
    {"rapportcycliquec", {"d_c", NULL, false}},
    {"uzk", {"u_dc_V", NULL, false}},
    {"zwischenkreisspannung", {"u_dc_V", NULL, false}},
    {"tensionbus", {"u_dc_V", NULL, false}},
    {"winkel", {"theta_e_rad", NULL, false}},
    {"elektrischerwinkel", {"theta_e_rad", NULL, false}},
    {"anglelectrique", {"theta_e_rad", NULL, false}},
    {"angleelectrique", {"theta_e_rad", NULL, false}},
    {"rotorwinkel", {"theta_e_rad", NULL, true}},
    {"anglerotor", {"theta_e_rad", NULL, true}},
    {"vitesse", {"omega_e_rad_s", "rpm", true}},
    {"temps", {"t_s", NULL, false}},
    {"temperatur", {"temp_C", NULL, false}},
    /* VESC Tool */
    {"mstoday", {"t_s", "ms", false}},
    {"daxiscurrent", {"i_d_A", NULL, false}},
    {"qaxiscurrent", {"i_q_A", NULL, false}},
    {"daxisvoltage", {"u_d_V", NULL, false}},
    {"qaxisvoltage", {"u_q_V", NULL, false}},
    {"inputvoltage", {"u_dc_V", NULL, false}},
    {"erpm", {"omega_e_rad_s", "rpm", false}},
    {"encoderposition", {"theta_e_rad", "deg", true}},
    /* ODrive */
    {"idmeasured", {"i_d_A", NULL, false}},
    {"iqmeasured", {"i_q_A", NULL, false}},
    {"ialphameasured", {"i_alpha_A", NULL, false}},
    {"ibetameasured", {"i_beta_A", NULL, false}},
    {"currentmeasphb", {"i_b_A", NULL, false}},
    {"currentmeasphc", {"i_c_A", NULL, false}},
    {"finalvalpha", {"u_alpha_V", NULL, false}},
    {"finalvbeta", {"u_beta_V", NULL, false}},
    {"vbusvoltage", {"u_dc_V", NULL, false}},
    {"phasevel", {"omega_e_rad_s", NULL, false}},
    {"phase", {"theta_e_rad", NULL, false}},
    /* moteus */
    {"cur1a", {"i_a_A", NULL, false}},
    {"cur2a", {"i_b_A", NULL, false}},
    {"cur3a", {"i_c_A", NULL, false}},
    {"electricaltheta", {"theta_e_rad", NULL, false}},
    {"filtbusv", {"u_dc_V", NULL, false}},
    {"busv", {"u_dc_V", NULL, false}},
    /* SimpleFOC */
    {"currentd", {"i_d_A", NULL, false}},
    {"currentq", {"i_q_A", NULL, false}},
    {"voltaged", {"u_d_V", NULL, false}},
    {"voltageq", {"u_q_V", NULL, false}},
    {"shaftangle", {"theta_e_rad", NULL, true}},
    {"shaftvelocity", {"omega_e_rad_s", NULL, true}},
    /* motulator */
    {"isa", {"i_a_A", NULL, false}},
    {"isb", {"i_b_A", NULL, false}},
    {"isc", {"i_c_A", NULL, false}},
    {"wm", {"omega_e_rad_s", NULL, false}},
};

static const struct {
    const char *spelt, *word;
} units[] = {
    {"s", "s"},         {"ms", "ms"},       {"us", "us"},        {"\xC2\xB5s", "us"}, {"ns", "ns"},
    {"A", "A"},         {"mA", "mA"},       {"kA", "kA"},        {"V", "V"},          {"mV", "mV"},
    {"kV", "kV"},       {"rad", "rad"},     {"deg", "deg"},      {"\xC2\xB0", "deg"}, {"turn", "turn"},
    {"rev", "turn"},    {"count", "count"}, {"counts", "count"}, {"rad/s", "rad/s"},  {"rpm", "rpm"},
    {"RPM", "rpm"},     {"1/min", "rpm"},   {"min-1", "rpm"},    {"U/min", "rpm"},    {"tr/min", "rpm"},
    {"Hz", "Hz"},       {"deg/s", "deg/s"}, {"%", "percent"},    {"C", "C"},          {"degC", "C"},
    {"\302\260C", "C"},
};

const char *foreign_unit_find(const char *word, size_t length)
{
    if (length >= 2 && strchr("[(", word[0]) != NULL && strchr("])", word[length - 1]) != NULL) {
        word++;
        length -= 2;
    }
    for (size_t n = 0; n < sizeof units / sizeof *units; n++) {
        if (strlen(units[n].spelt) == length && memcmp(units[n].spelt, word, length) == 0) {
            return units[n].word;
        }
    }
    return NULL;
}

/* Small letters and digits only; false if there are none, or too many. */
static bool canonical(const char *name, size_t length, char out[NAME_MOST])
{
    size_t n = 0;
    for (size_t k = 0; k < length; k++) {
        const unsigned char c = (unsigned char)name[k];
        if (isalnum(c)) {
            if (n + 1 == NAME_MOST) {
                return false;
            }
            out[n++] = (char)tolower(c);
        }
    }
    out[n] = '\0';
    return n > 0;
}

static foreign_name look_up(const char *name, size_t length)
{
    char plain[NAME_MOST];
    if (canonical(name, length, plain)) {
        for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
            if (strcmp(names[k].name, plain) == 0) {
                return names[k].is;
            }
        }
    }
    return (foreign_name){NULL, NULL, false};
}

/* First the whole name, then the part after its last point ("axis0.motor.foc.Iq_measured"). */
static foreign_name look_up_path(const char *name, size_t length)
{
    foreign_name found = look_up(name, length);
    for (size_t k = length; found.key == NULL && k-- > 0;) {
        if (name[k] == '.' && k + 1 < length) {
            found = look_up(name + k + 1, length - k - 1);
            break;
        }
    }
    return found;
}

/* Without the unit at its end, after one of these characters. */
static foreign_name look_up_with_unit(const char *name, size_t length, const char *marks)
{
    for (size_t k = 1; k < length; k++) {
        if (strchr(marks, name[k]) == NULL) {
            continue;
        }
        const size_t from = strchr("[(", name[k]) != NULL ? k : k + 1;
        const char *word = foreign_unit_find(name + from, length - from);
        foreign_name found = word != NULL ? look_up_path(name, k) : (foreign_name){NULL, NULL, false};
        if (found.key != NULL) {
            found.unit = word;
            return found;
        }
    }
    return (foreign_name){NULL, NULL, false};
}

foreign_name foreign_name_find(const char *name, size_t length)
{
    /* "I_A" is a phase, not a current in A; "rad/s" has a slash of its own. */
    foreign_name found = look_up_with_unit(name, length, "[(");
    if (found.key == NULL) {
        found = look_up_path(name, length);
    }
    return found.key != NULL ? found : look_up_with_unit(name, length, "_ /.");
}
