/* The stacks of contact_rest.c after a minute. */
#define UNTIL 60
#include "tests/plugins/correctors/contact_rest.c" /* NOLINT(bugprone-suspicious-include) */
