/* Recordings: what is read, what is refused and where, stretches, and that writing loses nothing. */
#include "data/recording.h"
#include "host_files.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unity.h>
#include <zlib.h>

static const char header[] = "t_s,i_a_A,i_b_A,theta_e_rad,omega_e_rad_s,u_a_V,u_b_V,u_c_V\n";

static recording r;

void setUp(void)
{
    r = (recording){0};
}

void tearDown(void)
{
    recording_free(&r);
}

static void expect_read(const char *text)
{
    error e = {0};
    recording_free(&r);
    TEST_ASSERT_TRUE_MESSAGE(recording_read(scratch_text("r.csv", text), &r, &e), e.text);
}

/* `where` is "line:column", `what` a part of the message. */
static void expect_refused(const char *text, const char *where, const char *what)
{
    error e = {0};
    const char *path = scratch_text("r.csv", text);
    recording_free(&r);
    TEST_ASSERT_FALSE_MESSAGE(recording_read(path, &r, &e), text);
    TEST_ASSERT_EQUAL(STATUS_UNUSABLE, e.status);
    char start[500];
    snprintf(start, sizeof start, "%s:%s: ", path, where);
    TEST_ASSERT_EQUAL_STRING_LEN_MESSAGE(start, e.text, strlen(start), e.text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(e.text, what), e.text);
    TEST_ASSERT_NULL(r.t_s);
    TEST_ASSERT_EQUAL(0, r.rows);
}

/* The header and one row that is replaced by `row`, with a good one ahead of it. */
static void expect_row_refused(const char *row, const char *where, const char *what)
{
    char text[2000];
    snprintf(text, sizeof text, "%s0,1,2,3,4,5,6,7\n%s", header, row);
    expect_refused(text, where, what);
}

static void test_a_plain_file(void)
{
    expect_read("t_s,i_a_A,i_b_A,theta_e_rad,omega_e_rad_s,u_a_V,u_b_V,u_c_V\n"
                "0.0,1.5,-0.5,0.1,100,10,-4,-6\n"
                "2e-4,1.25,-0.25,0.12,100,11,-5,-6\n");
    TEST_ASSERT_EQUAL(2, r.rows);
    TEST_ASSERT_TRUE(r.t_s[1] == 2e-4);
    TEST_ASSERT_TRUE(r.i_A[0][0] == 1.5 && r.i_A[1][0] == -0.5 && r.i_A[2][0] == -1.0);
    TEST_ASSERT_FALSE(r.i_c_measured);
    TEST_ASSERT_TRUE(r.theta_e_rad[1] == 0.12 && r.omega_e_rad_s[1] == 100.0);
    TEST_ASSERT_TRUE(r.u_V[2][1] == -6.0);
    TEST_ASSERT_NULL(r.duty[0]);
    TEST_ASSERT_NULL(r.u_dc_V);
    TEST_ASSERT_NULL(r.i_mid_A[0]);
    TEST_ASSERT_NULL(r.run);
    TEST_ASSERT_EQUAL(3, r.line[1]);
    TEST_ASSERT_EQUAL(1, r.stretches);
    TEST_ASSERT_TRUE(r.T_s == 2e-4);
}

/* All that RFC 4180 and interfaces.md allow at once. */
static void test_every_liberty_of_the_format(void)
{
    expect_read(
        "\xEF\xBB\xBF# bench 2, operator kl\r\n"
        "# \"an open quote\r\n"
        "\r\n"
        "\"note, with a comma\",u_dc_V,d_c,d_b,d_a,omega_e_rad_s,theta_e_rad,i_b_A,i_a_A,\"t_s\",run,i_c_A,"
        "i_b_mid_A,i_a_mid_A,temp_C,theta_mech_rad\r\n"
        "\"two\r\nlines, \"\"quoted\"\"\",600,0.5,0.25,0.75,-3,7,2,\"1\", 0.5 ,1,-3,4,5,25,9\r\n"
        ",600,0.5,0.25,0.75,-3,7,2,1,0.25,2,-3,4,5,26,9");
    TEST_ASSERT_EQUAL(2, r.rows);
    TEST_ASSERT_TRUE(r.t_s[0] == 0.5 && r.t_s[1] == 0.25);
    TEST_ASSERT_TRUE(r.i_c_measured && r.i_A[2][0] == -3.0);
    TEST_ASSERT_TRUE(r.i_mid_A[0][0] == 5.0 && r.i_mid_A[1][0] == 4.0 && r.i_mid_A[2][0] == -9.0);
    TEST_ASSERT_TRUE(r.temp_C[1] == 26.0 && r.theta_mech_rad[1] == 9.0);
    TEST_ASSERT_EQUAL(2, r.run[1]);
    TEST_ASSERT_EQUAL(5, r.line[0]);
    TEST_ASSERT_EQUAL(7, r.line[1]);
    TEST_ASSERT_EQUAL(2, r.stretches);

    double u_V[3];
    recording_voltage(&r, 0, u_V); /* duties less their mean, times u_dc */
    TEST_ASSERT_TRUE(u_V[0] == 150.0 && u_V[1] == -150.0 && u_V[2] == 0.0);
}

/* A line without quotes is parted at its commas at once: it must come out as the slow way has it, which gets the line with one
 * quoted field. */
static void test_plain_lines_are_read_as_quoted_ones(void)
{
    static const char *const ends[] = {"\n", "\r\n"};
    static const char *const spaces[] = {"", " ", "\t", " \t "};
    for (unsigned k = 0; k < 128; k++) {
        char plain[300];
        char quoted[300];
        const char *space = spaces[k % 4];
        const char *end = ends[k / 4 % 2];
        const char *note = k / 8 % 2 == 0 ? "" : "a # note";
        const char *blank = k / 16 % 2 == 0 ? "" : "\n \t\r\n\r\n";
        const char *last = k / 32 % 2 == 0 ? "" : end;
        const char *form = "%s,%st_s,i_a_A%s,i_b_A,theta_e_rad,omega_e_rad_s,u_a_V,u_b_V,u_c_V%s%s"
                           "%s,0,1%s,%s2,3,4,5,6,7%s%s%s%s,1,-1e3%s,2,3,4,5,6,%s+7%s";
        snprintf(plain, sizeof plain, form, "note", space, space, end, blank, note, space, space, space, end,
                 blank, note, space, space, last);
        char quoted_note[20];
        snprintf(quoted_note, sizeof quoted_note, "\"%s\"", note);
        snprintf(quoted, sizeof quoted, form, "\"note\"", space, space, end, blank, quoted_note, space, space,
                 space, end, blank, quoted_note, space, space, last);
        double values[2][2][3];
        long lines[2][2];
        for (int which = 0; which < 2; which++) {
            expect_read(which == 0 ? plain : quoted);
            TEST_ASSERT_EQUAL(2, r.rows);
            for (int row = 0; row < 2; row++) {
                values[which][row][0] = r.i_A[0][row];
                values[which][row][1] = r.i_A[1][row];
                values[which][row][2] = r.u_V[2][row];
                lines[which][row] = r.line[row];
            }
        }
        TEST_ASSERT_EQUAL_MEMORY(values[0], values[1], sizeof values[0]);
        TEST_ASSERT_EQUAL_MEMORY(lines[0], lines[1], sizeof lines[0]);
        TEST_ASSERT_TRUE(values[0][0][0] == 1.0 && values[0][1][0] == -1e3 && values[0][1][2] == 7.0);
    }
    /* A return alone ends a row; so does the end of the file. */
    char text[300];
    snprintf(text, sizeof text, "%s0,1,2,3,4,5,6,7\r1,1,2,3,4,5,6,7\n2,1,2,3,4,5,6,7", header);
    expect_read(text);
    TEST_ASSERT_EQUAL(3, r.rows);
    /* The first wrong field is where it is in the quoted line too. */
    expect_row_refused("1, 1,x,3,4,5,6,7\n", "3:6", "i_b_A \"x\" is not a number");
    expect_row_refused("1,\"1\",x,3,4,5,6,7\n", "3:7", "i_b_A \"x\" is not a number");
    /* A quoted field that begins behind a return goes on in the next line. */
    snprintf(text, sizeof text, "%s0,1,2,3,4,5,6,7\r\"1\n\",1,2,3,4,5,6,7\n", header);
    error e = {0};
    TEST_ASSERT_FALSE(recording_read(scratch_text("r.csv", text), &r, &e));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(e.text, "t_s \"1?\" is not a number"), e.text);
}

/* What would fill memory or keep its user waiting ends in a line that says so. */
static void test_sizes_are_bounded(void)
{
    enum { MEGABYTE = 1024 * 1024 };
    char *text = malloc(3 * MEGABYTE);
    const size_t start = (size_t)snprintf(text, 200, "%s0,1,2,3,4,5,6,", header);
    memset(text + start, '7', MEGABYTE + 10);
    strcpy(text + start + MEGABYTE + 10, "\n");
    error e = {0};
    TEST_ASSERT_FALSE(recording_read(scratch_text("r.csv", text), &r, &e));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(e.text, ":2: the line is longer than 1 MiB"), e.text);

    /* A quoted field may go on over lines, but not on and on. */
    e = (error){0};
    text[start] = '"';
    memset(text + start + 1, 'x', MEGABYTE + 10);
    for (size_t k = 1000; k < MEGABYTE; k += 1000) {
        text[start + k] = '\n';
    }
    strcpy(text + start + MEGABYTE + 11, "\"\n");
    TEST_ASSERT_FALSE(recording_read(scratch_text("r.csv", text), &r, &e));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(e.text, ":2: a quoted field over several lines"), e.text);

    /* A million blank lines are allowed, and no more. */
    e = (error){0};
    memset(text + start, '7', 1);
    memset(text + start + 1, '\n', 1000000);
    strcpy(text + start + 1000001, "1,1,2,3,4,5,6,7\n");
    TEST_ASSERT_TRUE_MESSAGE(recording_read(scratch_text("r.csv", text), &r, &e), e.text);
    recording_free(&r);
    memset(text + start + 1, '\n', 1000003);
    strcpy(text + start + 1000004, "1,1,2,3,4,5,6,7\n");
    TEST_ASSERT_FALSE(recording_read(scratch_text("r.csv", text), &r, &e));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(e.text, "more than a million lines without a row"), e.text);
    free(text);
}

static void test_voltages_win_over_duties(void)
{
    expect_read("t_s,i_a_A,i_b_A,theta_e_rad,omega_e_rad_s,u_a_V,u_b_V,u_c_V,d_a,d_b,d_c,u_dc_V\n"
                "0,1,2,3,4,5,6,7,0.1,0.2,0.3,600\n");
    double u_V[3];
    recording_voltage(&r, 0, u_V);
    TEST_ASSERT_TRUE(u_V[0] == 5.0 && u_V[1] == 6.0 && u_V[2] == 7.0);
    TEST_ASSERT_TRUE(r.duty[2][0] == 0.3 && r.u_dc_V[0] == 600.0);
    TEST_ASSERT_TRUE(r.T_s == 0.0); /* one row has no step */
}

static void test_half_a_group_next_to_a_whole_one_is_ignored(void)
{
    expect_read("t_s,i_a_A,i_b_A,theta_e_rad,omega_e_rad_s,u_a_V,u_b_V,u_c_V,d_a,d_b,d_c,i_a_mid_A\n"
                "0,1,2,3,4,5,6,7,0.1,0.2,0.3,x\n");
    TEST_ASSERT_NULL(r.duty[0]);
    TEST_ASSERT_NULL(r.i_mid_A[0]);
}

static void test_columns_that_must_be_there(void)
{
    expect_refused("t_s,i_a_A,i_b_A,omega_e_rad_s,u_a_V,u_b_V,u_c_V\n0,1,2,3,4,5,6\n", "1:1",
                   "missing column: theta_e_rad; found t_s,i_a_A,i_b_A,omega_e_rad_s,u_a_V,u_b_V,u_c_V;");
    expect_refused("# c\nt_s,i_b_A,omega_e_rad_s\n0,1,2\n", "2:1",
                   "missing columns: i_a_A, theta_e_rad, u_a_V, u_b_V, u_c_V (or d_a, d_b, d_c and u_dc_V);");
    expect_refused("t_s,i_a_A,i_b_A,theta_e_rad,omega_e_rad_s,d_a,d_b,d_c\n0,1,2,3,4,5,6,7\n", "1:1",
                   "missing column: u_dc_V (for the duties);");
    expect_refused("t_s,i_a_A,i_b_A,\xC3\xA9,i_a_A,theta_e_rad\n", "1:19",
                   "column i_a_A is twice in the header");
    expect_refused("0.1,0.2,0.3\n0.2,0.2,0.3\n", "1:1", "missing columns: t_s, i_a_A, i_b_A, theta_e_rad,");
    /* Names of other programs are explained as a map has them; unknown names are not. */
    expect_refused("time,Ia [mA],theta\n0,1,2\n", "1:1", "i_a_A = \"Ia [mA]\", theta_e_rad = \"theta\")");
    expect_refused("x,y\n0,1\n", "1:1", "found x,y; `iqfoc import` makes a recording of other logs");
}

static void test_fields_that_are_no_numbers(void)
{
    expect_row_refused("1,1,abc,3,4,5,6,7\n", "3:5", "i_b_A \"abc\" is not a number");
    expect_row_refused("1,1,2,3,4,5,6,7 V\n", "3:15", "u_c_V \"7 V\" is not a number");
    expect_row_refused("1,1,NaN,3,4,5,6,7\n", "3:5", "i_b_A \"NaN\" is not finite");
    expect_row_refused("1,-inf,2,3,4,5,6,7\n", "3:3", "i_a_A \"-inf\" is not finite");
    expect_row_refused("1,,2,3,4,5,6,7\n", "3:3", "i_a_A is empty");
    expect_row_refused("1,1e999,2,3,4,5,6,7\n", "3:3", "too large");
    expect_row_refused("1,0x10,2,3,4,5,6,7\n", "3:3", "\"0x10\"");
    expect_row_refused(header, "3:1", "the header is repeated here");
    expect_row_refused("1,\"a\nb\",2,3,4,5,6,7\n", "3:3", "\"a?b\" is not a number");
    expect_row_refused("# a late comment\n", "3:1", "t_s \"# a late comment\" is not a number");
    expect_refused("run,t_s,i_a_A,i_b_A,theta_e_rad,omega_e_rad_s,u_a_V,u_b_V,u_c_V\n1.5,0,1,2,3,4,5,6,7\n",
                   "2:1", "run \"1.5\" is not a whole number");
}

static void test_rows_of_another_length(void)
{
    expect_row_refused("1,1,2,3,4,5,6\n", "3:1", "the row has 7 fields, the header has 8");
    expect_row_refused("1,1,2,3", "3:1", "cut off?");
    expect_row_refused("1,1,2,3,4,5,6,7,8\n", "3:17", "the row has 9 fields, the header has 8");
    expect_row_refused("1,1,2,3,4,5,6,\"7", "3:15", "a quoted field has no end");
    expect_row_refused("1,1,2,3,4,5,6,\"7\"x\n", "3:15", "RFC 4180");
}

static void test_time_that_does_not_rise(void)
{
    expect_row_refused("0,1,2,3,4,5,6,7\n", "3:1", "t_s = 0 does not rise");
    expect_row_refused("0,1,2,3,4,5,6,7\n", "3:1", "too few decimals");
    expect_refused("run,i_a_A,i_b_A,theta_e_rad,omega_e_rad_s,u_a_V,u_b_V,u_c_V,t_s\n"
                   "1,1,2,3,4,5,6,7,0.5\n2,1,2,3,4,5,6,7,0.1\n2,1,2,3,4,5,6,7,0.05\n",
                   "4:17", "t_s = 0.05 does not rise: the row before has 0.1");
}

static void test_files_without_rows(void)
{
    expect_refused("", "1:1", "the file is empty");
    expect_refused("# only a comment\n", "1:1", "the file is empty");
    expect_refused(header, "2:1", "the file ends after its header");
    error e = {0};
    TEST_ASSERT_FALSE(recording_read(scratch_path("absent.csv"), &r, &e));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(e.text, "absent.csv: cannot be read: No such file"), e.text);
    error directory = {0};
    TEST_ASSERT_FALSE(recording_read(scratch_path(""), &r, &directory));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(directory.text, "is a directory"), directory.text);
}

/* A binary file given in a recording's place must neither crash the reader nor fill the memory. */
static void test_bytes_at_random(void)
{
    unsigned state = 12345; /* seed; a linear congruential generator */
    char *bytes = malloc(3000000);
    TEST_ASSERT_NOT_NULL(bytes);
    for (size_t i = 0; i < 3000000; i++) {
        state = state * 1664525u + 1013904223u;
        bytes[i] = (char)((state >> 16) | 1); /* no newline: all bytes are odd, so never 0x0A */
    }
    error e = {0};
    TEST_ASSERT_FALSE(recording_read(scratch_file("bytes", bytes, 3000000), &r, &e));
    TEST_ASSERT_EQUAL(STATUS_UNUSABLE, e.status);
    free(bytes);
}

/* Without a speed it is the angle's slope: exact for a rotor that accelerates, however the angle wraps. */
static void test_speed_from_the_angle(void)
{
    enum { ROWS = 60 };
    const double T_s = 2e-4;
    char text[8000] = "run,t_s,i_a_A,i_b_A,theta_e_rad,u_a_V,u_b_V,u_c_V\n";
    for (int k = 0; k < ROWS; k++) {
        const double t_s = (k % 30) * T_s;
        const double theta_rad = k < 30 ? 500.0 * t_s + 0.5 * 3e4 * t_s * t_s : 1.0 - 7000.0 * t_s;
        char row[160];
        snprintf(row, sizeof row, "%d,%.17g,1,2,%.17g,5,6,7\n", k / 30, t_s,
                 remainder(theta_rad, 6.283185307179586));
        strcat(text, row);
    }
    expect_read(text);
    TEST_ASSERT_TRUE(r.omega_derived);
    for (int k = 0; k < ROWS; k++) {
        const double t_s = (k % 30) * T_s;
        const double expected = k < 30 ? 500.0 + 3e4 * t_s : -7000.0;
        TEST_ASSERT_TRUE(fabs(r.omega_e_rad_s[k] - expected) < 1e-6);
    }
    /* Two rows are a line, one is nothing. */
    expect_read("run,t_s,i_a_A,i_b_A,theta_e_rad,u_a_V,u_b_V,u_c_V\n"
                "1,0,1,2,6.2,5,6,7\n1,0.01,1,2,0.2,5,6,7\n2,0,1,2,3,5,6,7\n");
    TEST_ASSERT_TRUE(fabs(r.omega_e_rad_s[1] - (0.2 - 6.2 + 6.283185307179586) / 0.01) < 1e-9);
    TEST_ASSERT_TRUE(r.omega_e_rad_s[0] == r.omega_e_rad_s[1] && r.omega_e_rad_s[2] == 0.0);
    expect_read(
        "t_s,i_a_A,i_b_A,theta_e_rad,omega_e_rad_s,u_a_V,u_b_V,u_c_V\n0,1,2,3,4,5,6,7\n1,1,2,9,4,5,6,7\n");
    TEST_ASSERT_FALSE(r.omega_derived);
    TEST_ASSERT_TRUE(r.omega_e_rad_s[1] == 4.0);
}

/* Found by fuzz_recording: a speed that no recording may hold was derived, and not written again. */
static void test_a_speed_beyond_any_is_not_derived(void)
{
    error e = {0};
    const char *path = scratch_text("r.csv", "t_s,i_a_A,i_b_A,theta_e_rad,u_a_V,u_b_V,u_c_V\n"
                                             "0,1,2,0,5,6,7\n1e-7,1,2,0.5,5,6,7\n2e-7,1,2,1,5,6,7\n");
    recording_free(&r);
    TEST_ASSERT_FALSE(recording_read(path, &r, &e));
    TEST_ASSERT_EQUAL(STATUS_UNUSABLE, e.status);
    char expected[500];
    snprintf(
        expected, sizeof expected,
        "%s: theta_e_rad turns at 5e+06 rad/s in row 1, where a cycle is 1e-07 s; expected at most 1e+06 "
        "rad/s: is t_s in seconds?",
        path);
    TEST_ASSERT_EQUAL_STRING(expected, e.text);
    TEST_ASSERT_NULL(r.t_s);
}

static void test_gaps_and_runs_end_stretches(void)
{
    char text[4000];
    strcpy(text, "run,t_s,i_a_A,i_b_A,theta_e_rad,omega_e_rad_s,u_a_V,u_b_V,u_c_V\n");
    /*
     * Steps of 0.1 but for one of 0.14 (no gap) and one of 0.16 (a gap); then run 7, which starts again at 0.
     */
    const double t_s[] = {0.0, 0.1, 0.2, 0.34, 0.44, 0.54, 0.70, 0.80, 0.0, 0.1};
    for (size_t k = 0; k < sizeof t_s / sizeof t_s[0]; k++) {
        char row[100];
        snprintf(row, sizeof row, "%d,%.2f,1,2,3,4,5,6,7\n", k < 8 ? 3 : 7, t_s[k]);
        strcat(text, row);
    }
    expect_read(text);
    TEST_ASSERT_EQUAL(3, r.stretches);
    TEST_ASSERT_EQUAL(0, r.stretch[0].first);
    TEST_ASSERT_EQUAL(6, r.stretch[0].count);
    TEST_ASSERT_EQUAL(3, r.stretch[0].run);
    TEST_ASSERT_EQUAL(6, r.stretch[1].first);
    TEST_ASSERT_EQUAL(2, r.stretch[1].count);
    TEST_ASSERT_EQUAL(8, r.stretch[2].first);
    TEST_ASSERT_EQUAL(2, r.stretch[2].count);
    TEST_ASSERT_EQUAL(7, r.stretch[2].run);
    TEST_ASSERT_TRUE(fabs(r.T_s - 0.1) < 1e-12);
}

/* gzip by its bytes, whatever its name; a cut file is refused, not half read. */
static void test_gzip(void)
{
    const char *path = scratch_path("packed.csv");
    gzFile out = gzopen(path, "wb");
    gzputs(out, header);
    unsigned state = 1; /* seed; noise, so that the packed file is long enough to be cut in its middle */
    for (int k = 0; k < 20000; k++) {
        state = state * 1664525u + 1013904223u;
        gzprintf(out, "%d,%u,2,3,4,5,6,7\n", k, state >> 13);
    }
    gzclose(out);
    error e = {0};
    TEST_ASSERT_TRUE_MESSAGE(recording_read(path, &r, &e), e.text);
    TEST_ASSERT_EQUAL(20000, r.rows);
    TEST_ASSERT_EQUAL(20001, r.line[19999]);
    recording_free(&r);

    FILE *in = fopen(path, "rb");
    static char bytes[60000];
    const size_t length = fread(bytes, 1, sizeof bytes, in);
    fclose(in);
    TEST_ASSERT_EQUAL(sizeof bytes, length);
    TEST_ASSERT_FALSE(recording_read(scratch_file("cut.csv.gz", bytes, length), &r, &e));
    TEST_ASSERT_EQUAL(STATUS_UNUSABLE, e.status);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(e.text, "cut or damaged"), e.text);

    error damaged = {0};
    memset(bytes + 30000, 0x55, 2000);
    TEST_ASSERT_FALSE(recording_read(scratch_file("damaged.csv.gz", bytes, length), &r, &damaged));
    TEST_ASSERT_EQUAL(STATUS_UNUSABLE, damaged.status);
}

/* All columns, values with all of a double's digits, more rows than one block of the reader. */
static void test_written_is_read_back_to_the_same_bits(void)
{
    enum { ROWS = 10000 };
    recording w = {.rows = ROWS, .i_c_measured = true};
    double **const columns[] = {&w.t_s,           &w.i_A[0],         &w.i_A[1], &w.i_A[2],     &w.theta_e_rad,
                                &w.omega_e_rad_s, &w.u_V[0],         &w.u_V[1], &w.u_V[2],     &w.duty[0],
                                &w.duty[1],       &w.duty[2],        &w.u_dc_V, &w.i_mid_A[0], &w.i_mid_A[1],
                                &w.i_mid_A[2],    &w.theta_mech_rad, &w.temp_C};
    enum { COLUMNS = sizeof columns / sizeof columns[0] };
    w.run = malloc(ROWS * sizeof *w.run);
    for (int c = 0; c < COLUMNS; c++) {
        *columns[c] = malloc(ROWS * sizeof(double));
        for (int k = 0; k < ROWS; k++) {
            (*columns[c])[k] = c == 0 ? (double)k / 5000.0 : sin(1.0 + c + 0.37 * k) * pow(10.0, (k % 9) - 4);
        }
    }
    for (int k = 0; k < ROWS; k++) {
        w.run[k] = k / 3000 - 1;
    }
    error e = {0};
    TEST_ASSERT_TRUE_MESSAGE(recording_write(scratch_path("w.csv"), &w, "made by a test\nseed none", &e),
                             e.text);
    TEST_ASSERT_TRUE_MESSAGE(recording_read(scratch_path("w.csv"), &r, &e), e.text);
    TEST_ASSERT_EQUAL(ROWS, r.rows);
    for (int c = 0; c < COLUMNS; c++) {
        const size_t offset = (size_t)((char *)columns[c] - (char *)&w);
        const double *back = *(double **)(void *)((char *)&r + offset);
        TEST_ASSERT_EQUAL_MEMORY(*columns[c], back, ROWS * sizeof(double));
    }
    TEST_ASSERT_EQUAL_MEMORY(w.run, r.run, ROWS * sizeof *w.run);
    TEST_ASSERT_EQUAL(4, r.stretches);
    TEST_ASSERT_EQUAL(4, r.line[0]);
    TEST_ASSERT_TRUE(r.i_c_measured);

    /* A third current that was computed, not measured, is not claimed. */
    recording_free(&r);
    w.i_c_measured = false;
    TEST_ASSERT_TRUE_MESSAGE(recording_write(scratch_path("w.csv"), &w, NULL, &e), e.text);
    TEST_ASSERT_TRUE_MESSAGE(recording_read(scratch_path("w.csv"), &r, &e), e.text);
    TEST_ASSERT_FALSE(r.i_c_measured);
    TEST_ASSERT_TRUE(r.i_A[2][5] == -w.i_A[0][5] - w.i_A[1][5]);
    recording_free(&w);
}

int main(void)
{
    scratch_begin();
    UNITY_BEGIN();
    RUN_TEST(test_a_plain_file);
    RUN_TEST(test_every_liberty_of_the_format);
    RUN_TEST(test_plain_lines_are_read_as_quoted_ones);
    RUN_TEST(test_sizes_are_bounded);
    RUN_TEST(test_voltages_win_over_duties);
    RUN_TEST(test_half_a_group_next_to_a_whole_one_is_ignored);
    RUN_TEST(test_columns_that_must_be_there);
    RUN_TEST(test_fields_that_are_no_numbers);
    RUN_TEST(test_rows_of_another_length);
    RUN_TEST(test_time_that_does_not_rise);
    RUN_TEST(test_files_without_rows);
    RUN_TEST(test_bytes_at_random);
    RUN_TEST(test_speed_from_the_angle);
    RUN_TEST(test_a_speed_beyond_any_is_not_derived);
    RUN_TEST(test_gaps_and_runs_end_stretches);
    RUN_TEST(test_gzip);
    RUN_TEST(test_written_is_read_back_to_the_same_bits);
    const int failed = UNITY_END();
    scratch_end();
    return failed;
}
