#define _POSIX_C_SOURCE 200809L

#include "diagnose_many.h"

#include "base/json_file.h"
#include "base/out_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { PATH_SIZE = 4096 };

typedef struct job {
    const char *recording;
    char directory[PATH_SIZE];
    pid_t process;
    int status;
} job;

/* "a/b/rec.csv.gz" -> "DIRECTORY/rec". */
static bool place(job *j, const char *recording, const char *directory, error *e)
{
    const char *slash = strrchr(recording, '/');
    const char *name = slash ? slash + 1 : recording;
    size_t length = strlen(name);
    static const char *const endings[] = {".gz", ".csv"};
    for (size_t k = 0; k < 2; k++) {
        size_t n = strlen(endings[k]);
        length -= length > n && strncmp(name + length - n, endings[k], n) == 0 ? n : 0;
    }
    j->recording = recording;
    int n = snprintf(j->directory, sizeof j->directory, "%s/%.*s", directory, (int)length, name);
    return (n > 0 && n < PATH_SIZE) || error_input(e, recording, 0, 0, "the path of its results is too long");
}

static void start(job *j, diagnose_one *one, const void *request)
{
    fflush(NULL);
    j->process = fork();
    if (j->process != 0) {
        j->status = j->process < 0 ? STATUS_FAILED : 0;
        return;
    }
    error e = {0};
    int quiet = open("/dev/null", O_WRONLY);
    bool ok = quiet >= 0 && dup2(quiet, STDOUT_FILENO) >= 0 && one(request, j->recording, j->directory, &e);
    int status = ok ? STATUS_DONE : (e.status ? error_print(&e) : STATUS_FAILED);
    fflush(NULL);
    _exit(status);
}

/* Waits for any child and notes how it ended. */
static void finish_one(job *jobs, int n)
{
    int how = 0;
    pid_t process = wait(&how);
    for (int k = 0; k < n; k++) {
        if (process > 0 && jobs[k].process == process) {
            jobs[k].status = WIFEXITED(how) ? WEXITSTATUS(how) : STATUS_FAILED;
        }
    }
}

/* The line of one recording in the summary; what a refused one lacks is not there. */
static json_t *summarise(const job *j)
{
    char path[PATH_SIZE + 32];
    snprintf(path, sizeof path, "%s/diagnosis.json", j->directory);
    json_t *line = json_pack("{s:s, s:i}", "recording", j->recording, "status", j->status);
    json_t *all = j->status == STATUS_DONE ? json_load_file(path, 0, NULL) : NULL;
    static const char *const keys[] = {"verdict", "causes", "error", "summary"};
    for (size_t k = 0; all && k < sizeof keys / sizeof *keys; k++) {
        json_object_set(line, keys[k], json_object_get(all, keys[k]));
    }
    json_decref(all);
    return line;
}

static void print_line(const json_t *line)
{
    const char *words = json_string_value(json_object_get(line, "summary"));
    const char *verdict = json_string_value(json_object_get(line, "verdict"));
    printf("%s: %s%s%s\n", json_string_value(json_object_get(line, "recording")),
           verdict ? verdict : "could not be diagnosed", words ? ": " : "", words ? words : "");
}

bool diagnose_many(diagnose_one *one, const void *request, char *const recordings[], int n,
                   const char *directory, int *status, error *e)
{
    job *jobs = calloc((size_t)n, sizeof *jobs);
    if (!jobs) {
        return error_failure(e, 0, "out of memory");
    }
    bool ok = out_dir_make(directory, e);
    for (int k = 0; ok && k < n; k++) {
        ok = place(&jobs[k], recordings[k], directory, e);
        for (int other = 0; ok && other < k; other++) {
            if (strcmp(jobs[other].directory, jobs[k].directory) == 0) {
                ok = error_input(e, recordings[k], 0, 0, "its results would go where those of %s go, %s",
                                 recordings[other], jobs[k].directory);
            }
        }
    }
    long cores = sysconf(_SC_NPROCESSORS_ONLN);
    int running = 0;
    for (int k = 0; ok && k < n; k++) {
        if (running >= (cores > 0 ? cores : 1)) {
            finish_one(jobs, n);
            running--;
        }
        start(&jobs[k], one, request);
        running += jobs[k].process > 0;
    }
    for (; running > 0; running--) {
        finish_one(jobs, n);
    }
    *status = STATUS_DONE;
    json_t *lines = json_array();
    for (int k = 0; ok && k < n; k++) {
        json_t *line = summarise(&jobs[k]);
        print_line(line);
        json_array_append_new(lines, line);
        /* A failure of the program outweighs an unusable recording. */
        if (*status != STATUS_FAILED && jobs[k].status != STATUS_DONE) {
            *status = jobs[k].status;
        }
    }
    json_t *summary = json_pack("{s:i, s:o}", "schema", 1, "recordings", lines);
    char path[PATH_SIZE];
    snprintf(path, sizeof path, "%s/summary.json", directory);
    ok = ok && json_file_write(path, summary, e);
    json_decref(summary);
    free(jobs);
    return ok;
}
