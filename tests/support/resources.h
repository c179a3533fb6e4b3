/* What a run of the built hooke takes of the machine. */
#ifndef HK_TEST_RESOURCES_H
#define HK_TEST_RESOURCES_H

typedef struct test_resources {
  int code;       /* exit code; negative: it could not be run or was killed */
  double bytes;   /* largest resident memory */
  double seconds; /* processor time */
} test_resources;

/* Runs "hooke run SCENE ..." with the arguments, NULL ends them, and with what it prints left out. */
test_resources test_resources_of(const char *const *arguments);

#endif
