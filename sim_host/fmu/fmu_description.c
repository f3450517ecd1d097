/* modelDescription.xml, from the table of variables (fmu_description.h). */
#include "fmu_description.h"

#include "base/number.h"

#include "iqfoc/version.h"

#include <string.h>

typedef struct unit {
    const char *name;
    const char *of_base; /* attributes of BaseUnit */
} unit;

static const unit units[] = {
    {"1", ""},
    {"A", "A=\"1\""},
    {"V", "kg=\"1\" m=\"2\" s=\"-3\" A=\"-1\""},
    {"Ohm", "kg=\"1\" m=\"2\" s=\"-3\" A=\"-2\""},
    {"H", "kg=\"1\" m=\"2\" s=\"-2\" A=\"-2\""},
    {"Wb", "kg=\"1\" m=\"2\" s=\"-2\" A=\"-1\""},
    {"s", "s=\"1\""},
    {"rad", "rad=\"1\""},
    {"rpm", "s=\"-1\" rad=\"1\" factor=\"0.10471975511965977\""},
    {"rpm/s", "s=\"-2\" rad=\"1\" factor=\"0.10471975511965977\""},
    {"N.m", "kg=\"1\" m=\"2\" s=\"-2\""},
    {"N.m.s", "kg=\"1\" m=\"2\" s=\"-1\""},
    {"kg.m2", "kg=\"1\" m=\"2\""},
};

/* Text within an attribute. Control characters, which a name from a TOML file may hold, are none of XML's. */
static void put_text(FILE *out, const char *text)
{
    for (; *text != '\0'; text++) {
        switch (*text) {
        case '&':
            fputs("&amp;", out);
            break;
        case '<':
            fputs("&lt;", out);
            break;
        case '"':
            fputs("&quot;", out);
            break;
        default:
            fputc((unsigned char)*text < 32 ? ' ' : *text, out);
        }
    }
}

static void put_start(FILE *out, const fmu_variable *v, double value)
{
    char text[NUMBER_TEXT_SIZE];
    number_text(value, text);
    fprintf(out, " start=\"%s\"", v->type != FMU_TYPE_FLAG ? text : value != 0.0 ? "true" : "false");
}

static void put_variable(FILE *out, int id, double value)
{
    static const char *const types[] = {[FMU_TYPE_REAL] = "Float64",
                                        [FMU_TYPE_WHOLE] = "Int32",
                                        [FMU_TYPE_FLAG] = "Boolean",
                                        [FMU_TYPE_HASH] = "UInt64"};
    static const char *const causality[] = {[FMU_ROLE_INPUT] = "input",
                                            [FMU_ROLE_FIXED] = "parameter",
                                            [FMU_ROLE_TUNABLE] = "parameter",
                                            [FMU_ROLE_DERIVED] = "calculatedParameter",
                                            [FMU_ROLE_OUTPUT] = "output"};
    const fmu_variable *v = &fmu_variables[id];
    const bool parameter = v->role == FMU_ROLE_FIXED || v->role == FMU_ROLE_DERIVED;
    const char *variability = parameter                     ? "fixed"
                              : v->role == FMU_ROLE_TUNABLE ? "tunable"
                              : v->type == FMU_TYPE_REAL    ? "continuous"
                                                            : "discrete";
    const bool given = v->role != FMU_ROLE_DERIVED && v->role != FMU_ROLE_OUTPUT;
    fprintf(out, "    <%s name=\"%s\" valueReference=\"%u\" causality=\"%s\" variability=\"%s\"",
            types[v->type], v->name, (unsigned)fmu_reference_of(id), causality[v->role], variability);
    fprintf(out, " initial=\"%s\"", given ? "exact" : "calculated");
    if (v->unit != NULL) {
        fprintf(out, " unit=\"%s\"", v->unit);
    }
    if (given) {
        put_start(out, v, value);
    }
    fputs(" description=\"", out);
    put_text(out, v->what);
    fputs("\"/>\n", out);
}

static void put_head(FILE *out, const fmu_model *m)
{
    const fmu_setup *s = &m->setup;
    fputs("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription fmiVersion=\"3.0\" modelName=\"",
          out);
    put_text(out, s->motor.name[0] != '\0' ? s->motor.name : "drive");
    fprintf(out, " (%s)\"\n    instantiationToken=\"%s\"\n    description=\"", fmu_kind_words[s->kind],
            s->token);
    fputs(s->kind == FMU_KIND_DRIVE
              ? "Switching-level drive with the fixed-point current control of iqfoc"
              : "Switching-level plant: inverter, permanent-magnet machine, shaft and sensors",
          out);
    if (s->has_scenario) {
        fputs("; scenario ", out);
        put_text(out, s->scenario.name);
    }
    fputs("\"\n    generationTool=\"iqfoc " IQFOC_VERSION_STRING "\" license=\"MIT\">\n", out);
    char step[NUMBER_TEXT_SIZE];
    number_text(m->value[FMU_cycle_s], step);
    fprintf(out,
            "  <CoSimulation modelIdentifier=\"" FMU_IDENTIFIER
            "\" canHandleVariableCommunicationStepSize=\"true\"\n"
            "      canGetAndSetFMUState=\"true\" fixedInternalStepSize=\"%s\"/>\n",
            step);
    fputs("  <UnitDefinitions>\n", out);
    for (size_t k = 0; k < sizeof units / sizeof units[0]; k++) {
        fprintf(out, "    <Unit name=\"%s\"><BaseUnit%s%s/></Unit>\n", units[k].name,
                *units[k].of_base ? " " : "", units[k].of_base);
    }
    fputs("  </UnitDefinitions>\n  <LogCategories>\n    <Category name=\"logStatusError\"/>\n  "
          "</LogCategories>\n",
          out);
    char stop[NUMBER_TEXT_SIZE];
    const long cycles =
        s->has_scenario ? scenario_run_cycles(&s->scenario.run[s->run], m->value[FMU_cycle_s]) : 1000;
    number_text((double)cycles * m->value[FMU_cycle_s], stop);
    fprintf(out, "  <DefaultExperiment startTime=\"0\" stopTime=\"%s\" stepSize=\"%s\"/>\n", stop, step);
}

void fmu_description_write(FILE *out, const fmu_model *m)
{
    const fmu_kind kind = m->setup.kind;
    put_head(out, m);
    fputs("  <ModelVariables>\n    <Float64 name=\"time\" valueReference=\"0\" causality=\"independent\" "
          "variability=\"continuous\" unit=\"s\"/>\n",
          out);
    for (int id = 0; id < FMU_VARIABLES; id++) {
        if (fmu_variables[id].of[kind]) {
            put_variable(out, id, m->value[id]);
        }
    }
    fputs("  </ModelVariables>\n  <ModelStructure>\n", out);
    for (int id = 0; id < FMU_VARIABLES; id++) {
        if (fmu_variables[id].of[kind] && fmu_variables[id].role == FMU_ROLE_OUTPUT) {
            fprintf(out, "    <Output valueReference=\"%u\"/>\n", (unsigned)fmu_reference_of(id));
        }
    }
    for (int id = 0; id < FMU_VARIABLES; id++) {
        const fmu_role role = fmu_variables[id].role;
        if (fmu_variables[id].of[kind] && (role == FMU_ROLE_OUTPUT || role == FMU_ROLE_DERIVED)) {
            fprintf(out, "    <InitialUnknown valueReference=\"%u\"/>\n", (unsigned)fmu_reference_of(id));
        }
    }
    fputs("  </ModelStructure>\n</fmiModelDescription>\n", out);
}
