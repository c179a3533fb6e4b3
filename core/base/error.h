/* Errors: a status and one sentence, made where the cause is known. */
#ifndef HK_ERROR_H
#define HK_ERROR_H

#include "core/plugin.h"
#include <stdarg.h>

typedef struct hk_error {
  hk_status status;
  char text[1024];
} hk_error;

/* Fills `error` (unless it already holds one: the first cause counts) and returns `status`. */
hk_status hk_error_set(hk_error *error, hk_status status, const char *format, ...) HK_PRINTF(3, 4);
hk_status hk_error_setv(hk_error *error, hk_status status, const char *format, va_list arguments);

/* The name closest to `wrong` by edit distance, or NULL when none is close. `name(context, k)` is the k-th, NULL ends.
 */
const char *hk_nearest_name(const char *wrong, const char *(*name)(const void *context, size_t k), const void *context);

#endif
