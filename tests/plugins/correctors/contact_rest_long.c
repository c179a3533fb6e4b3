/* The stacks of contact_rest.c after a minute, ten sheets after 8 s; under sanitizers, where that would take a quarter
 * of an hour, after some seconds. */
#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define UNTIL 5
#endif
#endif
#if !defined(UNTIL) && defined(__SANITIZE_ADDRESS__)
#define UNTIL 5
#endif
#ifndef UNTIL
#define UNTIL 60
#endif
#define TALL 10
#define TALL_UNTIL (UNTIL / 8.)
#include "tests/plugins/correctors/contact_rest.c" /* NOLINT(bugprone-suspicious-include) */
