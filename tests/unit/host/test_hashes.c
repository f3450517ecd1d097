/* SHA-256 and base64 against the examples of FIPS 180-4 and RFC 4648, and in parts of every length. */
/* POSIX: open_memstream, mkstemp. */
#define _POSIX_C_SOURCE 200809L

#include "base/base64.h"
#include "base/sha256.h"

#include "unity.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

void setUp(void)
{
}

void tearDown(void)
{
}

static void expect_file(const char *content, size_t count, const char *expected)
{
    char path[] = "/tmp/iqfoc-hash-XXXXXX";
    char text[SHA256_TEXT];
    const int file = mkstemp(path);
    TEST_ASSERT_TRUE(file >= 0);
    TEST_ASSERT_EQUAL_INT((int)count, (int)write(file, content, count));
    close(file);
    const bool read = sha256_of_file(path, text);
    unlink(path);
    TEST_ASSERT_TRUE(read);
    TEST_ASSERT_EQUAL_STRING(expected, text);
}

static void test_sha256_of_the_standards_examples(void)
{
    static char million[1000000];
    static const char two_blocks[] = "abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq";
    memset(million, 'a', sizeof million);
    expect_file("", 0, "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    expect_file("abc", 3, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    expect_file(two_blocks, sizeof two_blocks - 1,
                "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    expect_file(million, sizeof million, "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

static void test_sha256_does_not_care_for_the_parts(void)
{
    unsigned char text[200];
    for (size_t n = 0; n < sizeof text; n++) {
        text[n] = (unsigned char)(7 * n);
    }
    for (size_t length = 0; length <= sizeof text; length++) {
        unsigned char whole[SHA256_BYTES];
        unsigned char parted[SHA256_BYTES];
        sha256 s = sha256_begin();
        sha256_add(&s, text, length);
        sha256_end(&s, whole);
        s = sha256_begin();
        for (size_t n = 0; n < length; n++) {
            sha256_add(&s, &text[n], 1);
        }
        sha256_end(&s, parted);
        TEST_ASSERT_EQUAL_MEMORY(whole, parted, SHA256_BYTES);
    }
}

static void test_what_cannot_be_read_has_no_digest(void)
{
    char text[SHA256_TEXT] = "x";
    TEST_ASSERT_FALSE(sha256_of_file("-", text));
    TEST_ASSERT_EQUAL_STRING("", text);
    TEST_ASSERT_FALSE(sha256_of_file("/nowhere/at/all", text));
    TEST_ASSERT_FALSE(sha256_of_file("/", text));
}

static void test_base64_of_the_standards_examples(void)
{
    static const char *const expected[] = {"", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"};
    for (size_t n = 0; n < sizeof expected / sizeof expected[0]; n++) {
        char *text = NULL;
        size_t size = 0;
        base64 b = {.out = open_memstream(&text, &size)};
        base64_add(&b, "foobar", n / 2);
        base64_add(&b, &"foobar"[n / 2], n - n / 2);
        base64_end(&b);
        fclose(b.out);
        TEST_ASSERT_EQUAL_STRING(expected[n], text);
        free(text);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_sha256_of_the_standards_examples);
    RUN_TEST(test_sha256_does_not_care_for_the_parts);
    RUN_TEST(test_what_cannot_be_read_has_no_digest);
    RUN_TEST(test_base64_of_the_standards_examples);
    return UNITY_END();
}
