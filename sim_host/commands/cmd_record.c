/* iqfoc record: read the target's recorder from a serial line (docs/recorder-format.md) and write a recording. */
#define _POSIX_C_SOURCE 200809L /* sigaction */
#include "base/confine.h"
#include "base/progress.h"
#include "command.h"
#include "line.h"
#include "options.h"
#include "record_rows.h"

#include <signal.h>
#include <stdio.h>

typedef struct request {
    const char *port, *out_path;
    long baud;
    double seconds; /* 0: no limit */
} request;

static request asked = {.baud = 1000000};

static const option_spec specs[] = {
    {"port", 'p', "DEV|PTY|SOCKET|FILE", "source of the bytes", .text = &asked.port, .needed = true},
    {"output", 'o', "REC.csv", "the recording; - is standard output", .text = &asked.out_path, .needed = true,
     .written = true},
    {"baud", 'b', "N", "speed of a serial device (default 1000000)", .integer = &asked.baud, .low = 1,
     .high = 10000000},
    {"seconds", 0, "X", "stop after this time; default: at the end frame, end of file or Ctrl-C",
     .number = &asked.seconds, .low = 1e-3, .high = 1e6},
    {.name = NULL}};

const command_about about_record = {
    "record",
    "--port DEV|PTY|SOCKET|FILE -o REC.csv [--baud N] [--seconds X]",
    "Reads the stream of the firmware's recorder and writes a recording. Counts lost and damaged frames.\n"
    "A missing row ends a stretch: the next stretch has another `run`.",
    specs,
};

static volatile sig_atomic_t interrupted;

static void on_interrupt(int number)
{
    (void)number;
    interrupted = 1;
}

/* A file is read to its end, as it may hold several streams. */
static bool receive(const request *r, line *l, wire_reader *reader, record_rows *rows, error *e)
{
    const double end_s = progress_clock_s() + r->seconds;
    /* The total is not known in advance: the progress line counts rows and damage. */
    progress p = progress_begin("record", 0.0, "");
    bool closed = false;
    while (!closed && !interrupted && (!reader->ended || l->size > 0) &&
           (r->seconds == 0.0 || progress_clock_s() < end_s)) {
        uint8_t octets[4096];
        size_t count = 0;
        if (!line_read(l, octets, sizeof octets, 100, &count, &closed, e)) {
            return false;
        }
        if (!wire_read(reader, octets, count, record_rows_take, rows)) {
            *e = rows->e;
            return false;
        }
        if (reader->version != 0) {
            return error_input(e, r->port, 0, 0, "the stream has format version %u; expected version 1",
                               (unsigned)reader->version);
        }
        const wire_counts *c = &reader->counts;
        progress_say(&p, "record: %zu rows, %lu frames, %lu damaged, %lu lost", rows->recording.rows,
                     c->frames, c->damaged, c->lost_frames);
    }
    wire_close(reader);
    progress_end(&p);
    return true;
}

/* Rows received and lost; on stderr, because stdout holds the recording with `-o -`. */
static void summarise(const record_rows *rows, const wire_reader *reader)
{
    const wire_counts *c = &reader->counts;
    fprintf(stderr,
            "iqfoc: record: %zu rows in %ld stretches; %lu frames, %lu damaged, %lu lost; %lu rows lost on "
            "the target, %lu missing in all",
            rows->recording.rows, rows->run, c->frames, c->damaged, c->lost_frames, c->lost_rows,
            c->missing_rows);
    if (c->headless_rows > 0) {
        fprintf(stderr, "; %lu rows before the first header", c->headless_rows);
    }
    fprintf(stderr, "%s\n", reader->ended ? "" : "; the stream had no end frame");
}

static bool write_out(const request *r, record_rows *rows, const wire_reader *reader, error *e)
{
    char comment[RECORD_COMMENT];
    record_comment(&reader->counts, comment, sizeof comment);
    return recording_write(r->out_path, &rows->recording, comment, e);
}

int cmd_record(int argc, char **argv)
{
    error e = {0, ""};
    options o = options_begin(&about_record, argc, argv);
    if (!options_read(&o, &e) || o.helped || !options_complete(&o, &e)) {
        return error_print(&e);
    }
    struct sigaction stop = {.sa_handler = on_interrupt};
    (void)sigaction(SIGINT, &stop, NULL);
    (void)sigaction(SIGTERM, &stop, NULL);

    static wire_reader reader;
    static record_rows rows;
    line l;
    bool good = line_open(&l, asked.port, asked.baud, &e);
    confine(CONFINE_TO_FILES); /* before the first byte is read */
    good = good && receive(&asked, &l, &reader, &rows, &e);
    if (good && rows.recording.rows == 0) {
        const wire_counts *c = &reader.counts;
        good = error_input(&e, asked.port, 0, 0, "no row received: %lu frames, %lu damaged, %lu lost",
                           c->frames, c->damaged, c->lost_frames);
    }
    if (good) {
        summarise(&rows, &reader);
        good = write_out(&asked, &rows, &reader, &e);
    }
    line_close(&l);
    record_rows_free(&rows);
    return good ? STATUS_DONE : error_print(&e);
}
