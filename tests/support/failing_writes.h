/* A disk that is full at one call: hooke runs under a filter (seccomp, user notification, Linux 5.5) that asks here
 * before every call by which it or a child of it changes files below a folder. */
#ifndef HK_TEST_FAILING_WRITES_H
#define HK_TEST_FAILING_WRITES_H

#include "tests/support/command.h"

typedef struct test_disk {
  long calls;      /* that there were, such as open to write, write, fsync, rename, close */
  char where[512]; /* what failed: the name of the call, and the file */
} test_disk;

bool test_disk_can_fail(void); /* whether this kernel has what it takes */
/* Runs "hooke ARGUMENTS" in test_folder()/NAME, where call `number` fails with that cause (errno.h); 0: none fails. */
void test_hooke_on_disk(test_result *, test_disk *, const char *name, long number, int cause, const char *arguments);

#endif
