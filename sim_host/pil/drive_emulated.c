/* Processor in the loop: the drive's calls as frames on the emulator's serial line (drive_emulated.h). */
#define _POSIX_C_SOURCE 200809L
#include "drive_emulated.h"

#include "per_unit.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define PATH_SIZE 4096

typedef struct target {
    const char *name, *emulator, *machine;
    const char *bios; /* "none" where the machine would bring its own, else NULL */
} target;

static const target targets[] = {
    {"cortex-m4", "qemu-system-arm", "mps2-an386", NULL},
    {"rv32", "qemu-system-riscv32", "virt", "none"},
};

static const target *target_named(const char *name)
{
    for (size_t k = 0; k < sizeof targets / sizeof targets[0]; k++) {
        if (strcmp(targets[k].name, name) == 0) {
            return &targets[k];
        }
    }
    return NULL;
}

/* build/host/iqfoc -> build/<target>/iqfoc_pil.elf. */
static bool image_beside_program(const char *name, char path[PATH_SIZE], error *e)
{
    char program[PATH_SIZE];
    const ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    if (length < 0) {
        return error_failure(e, 0, "simulate: cannot find out where this program lies; name the --image");
    }
    program[length] = '\0';
    for (int up = 0; up < 2; up++) {
        char *slash = strrchr(program, '/');
        if (slash != NULL) {
            *slash = '\0';
        }
    }
    const int wrote = snprintf(path, PATH_SIZE, "%s/%s/iqfoc_pil.elf", program, name);
    if (wrote < 0 || wrote >= PATH_SIZE) {
        return error_failure(e, 0, "simulate: the path of this program is too long");
    }
    return true;
}

/* The next frame of the image, of the type wanted. */
static bool receive(drive_emulated *d, uint32_t type, pil_frame_t *frame, error *e)
{
    for (;;) {
        uint8_t bytes[PIL_FRAME_MAX];
        size_t count = 0;
        if (!emulator_receive(&d->machine, bytes, sizeof bytes, &count, e)) {
            return false;
        }
        for (size_t k = 0; k < count; k++) {
            const pil_decoded_t decoded = pil_decode(&d->decoder, bytes[k], frame);
            if (decoded == PIL_MORE) {
                continue;
            }
            if (decoded == PIL_WHOLE && frame->type == type && k + 1 == count) {
                return true;
            }
            const bool complains = decoded == PIL_WHOLE && frame->type == PIL_GARBLED;
            drive_emulated_stop(d);
            return error_failure(e, 0, "%s: garbled exchange: %s", d->machine.name,
                                 complains ? "the image could not read what it was sent"
                                           : "what the image sent is no answer");
        }
    }
}

static bool exchange(drive_emulated *d, const pil_frame_t *question, uint32_t type, pil_frame_t *answer,
                     error *e)
{
    uint8_t bytes[PIL_FRAME_MAX];
    const uint32_t count = pil_encode(question, bytes);
    return emulator_send(&d->machine, bytes, count, e) && receive(d, type, answer, e);
}

/* The same where the image answers with one number, 0 if it has what it needs. */
static bool started(drive_emulated *d, const pil_frame_t *question, const char *complaint, error *e)
{
    pil_frame_t answer;
    return exchange(d, question, PIL_STARTED, &answer, e) &&
           (answer.data[0] == IQFOC_OK ||
            error_failure(e, 0, "%s: %s %d", d->machine.name, complaint, (int)answer.data[0]));
}

/* x as mantissa / 2^shift with a mantissa of 30 bits. x > 0. */
static void mantissa_of(double x, int32_t *mantissa, int32_t *shift)
{
    int exponent;
    (void)frexp(x, &exponent);
    *mantissa = (int32_t)lround(ldexp(x, 30 - exponent));
    *shift = 30 - exponent;
}

/* Tells the image's recorder what its numbers stand for. */
static bool recorder_start(drive_emulated *d, uint32_t type, const motor *m, error *e)
{
    const per_unit base = per_unit_of(m);
    pil_bases_t bases;
    mantissa_of(base.T_s, &bases.T_mantissa, &bases.T_shift);
    mantissa_of(base.I_A, &bases.I_mantissa, &bases.I_shift);
    mantissa_of(base.U_V, &bases.U_mantissa, &bases.U_shift);
    mantissa_of(VEC_TWO_PI / base.T_s, &bases.omega_mantissa, &bases.omega_shift);
    const pil_frame_t question = pil_record_frame(type, &bases);
    return started(d, &question, "the recorder refused its configuration:", e);
}

/* A line in both directions. */
static bool is_terminal(const char *path)
{
    struct stat found;
    return stat(path, &found) == 0 && S_ISCHR(found.st_mode) && strncmp(path, "/dev/", 5) == 0;
}

bool drive_emulated_start(drive_emulated *d, const drive_emulated_choice *choice, const motor *m, error *e)
{
    char beside[PATH_SIZE];
    char serial[PATH_SIZE];
    const target *t = target_named(choice->target);
    const char *image = choice->image;
    memset(d, 0, sizeof *d);
    if (t == NULL) {
        return error_input(e, NULL, 0, 0, "simulate: --target %s: expected cortex-m4 or rv32",
                           choice->target);
    }
    if (image == NULL) {
        if (!image_beside_program(t->name, beside, e)) {
            return false;
        }
        image = beside;
    }
    if (access(image, R_OK) != 0) {
        return error_input(e, image, 0, 0, "no image for --target %s; `tests/target/run.sh` builds it",
                           t->name);
    }
    const char *const kind = choice->uart == NULL ? "none" : is_terminal(choice->uart) ? "" : "file:";
    (void)snprintf(serial, sizeof serial, "%s%s", kind, choice->uart != NULL ? choice->uart : "");
    /* The image speaks by semihosting: to the emulator's standard input and output, which is our line. */
    const char *const semihosting = "enable=on,target=native";
    const char *const argv[] = {t->emulator, "-M",
                                t->machine,  "-serial",
                                serial,      "-semihosting-config",
                                semihosting, "-display",
                                "none",      "-monitor",
                                "none",      "-kernel",
                                image,       t->bios != NULL ? "-bios" : NULL,
                                t->bios,     NULL};
    const uint32_t recorded = choice->at_alarm ? PIL_RECORD_ALARM : PIL_RECORD;
    return emulator_start(&d->machine, t->name, argv, e) &&
           (choice->uart == NULL || recorder_start(d, recorded, m, e));
}

static bool emulated_start(void *context, const iqfoc_cycle_config_t *config, error *e)
{
    const pil_frame_t question = pil_start_frame(config);
    return started(context, &question, "the library refused its configuration: iqfoc_error_t", e);
}

static bool emulated_valley(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, error *e)
{
    (void)i_ref;
    (void)e;
    ((drive_emulated *)context)->valley = *sample;
    return true;
}

static bool emulated_peak(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, drive_answer *answer,
                          error *e)
{
    drive_emulated *d = context;
    const pil_frame_t question = pil_cycle_frame(i_ref, &d->valley, sample);
    pil_frame_t frame;
    pil_result_t result;
    if (!exchange(d, &question, PIL_COMMAND, &frame, e)) {
        return false;
    }
    pil_command_read(&frame, &result);
    answer->command = result.command;
    answer->status = result.status;
    return true;
}

drive_firmware drive_firmware_emulated(drive_emulated *d)
{
    return (drive_firmware){d, emulated_start, emulated_valley, emulated_peak};
}

bool drive_emulated_tune(drive_emulated *d, const tuned_firmware_config_t *config, error *e)
{
    const pil_frame_t question = pil_tune_frame(config);
    return started(d, &question, "the library refused the tuned firmware's corrections: iqfoc_error_t", e);
}

bool drive_emulated_watched(drive_emulated *d, pil_watched_t *watched, error *e)
{
    const pil_frame_t question = {PIL_ASK, 0, {0}};
    pil_frame_t answer;
    if (!exchange(d, &question, PIL_WATCHED, &answer, e)) {
        return false;
    }
    pil_watched_read(&answer, watched);
    return true;
}

bool drive_emulated_finish(drive_emulated *d, error *e)
{
    return emulator_finish(&d->machine, e);
}

void drive_emulated_stop(drive_emulated *d)
{
    emulator_stop(&d->machine);
}
