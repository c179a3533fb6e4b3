/* Running the built hooke as a user does. */
#ifndef HK_TEST_COMMAND_H
#define HK_TEST_COMMAND_H

#include <stdbool.h>

typedef struct test_result {
  int code;                        /* exit code; 128 + signal when it was killed */
  char out[1 << 16], err[1 << 14]; /* what it printed, cut at the size */
} test_result;

/* Runs "hooke ARGUMENTS" through the shell in a fresh folder of the test's own (test_folder()). `before` goes in front,
 * such as "ulimit -f 1;", or NULL. */
void test_hooke(test_result *, const char *before, const char *arguments);
/* Runs scripts/scenes/NAME.lua with --json and without output; fails the test where it ends with another code than 0.
 */
void test_scene(test_result *, const char *name, const char *options);
/* The fresh folder, made at the first call and removed at exit. */
const char *test_folder(void);
/* Writes a file there; returns its path (valid until the next 8 calls). */
const char *test_write(const char *name, const char *text);
bool test_exists(const char *name); /* in the folder */
/* The number behind "key": in JSON; NAN when it is null or not there. */
double test_json(const char *json, const char *key);
/* Fail the test unless the exit code is that and standard error contains the text. */
void test_refused(const char *scene, const char *arguments, int code, const char *text);

#endif
