/* Errors and the nearest name. The first error set is the cause; later errors, its consequences, do not replace it. */
#include "core/base/base.h"
#include "core/text/text.h"

#include <stdio.h>
#include <string.h>

hk_status hk_error_setv(hk_error *error, hk_status status, const char *format, va_list arguments) {
  if (error && error->status == HK_OK) {
    error->status = status;
    char text[sizeof error->text];
    vsnprintf(text, sizeof text, format, arguments);
    hk_plain_copy(error->text, sizeof error->text, text); /* names in it may be anything */
  }
  return status;
}

hk_status hk_error_set(hk_error *error, hk_status status, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  hk_error_setv(error, status, format, arguments);
  va_end(arguments);
  return status;
}

enum { HK_NAME_MAX = 63 };

/* Edit distance (Levenshtein) with one row; of longer names the beginnings are compared. */
static size_t edit_distance(const char *a, const char *b) {
  size_t row[HK_NAME_MAX + 1];
  size_t na = strnlen(a, HK_NAME_MAX), nb = strnlen(b, HK_NAME_MAX);
  for (size_t j = 0; j <= nb; j++) row[j] = j;
  for (size_t i = 1; i <= na; i++) {
    size_t diagonal = row[0];
    row[0] = i;
    for (size_t j = 1; j <= nb; j++) {
      size_t above = row[j];
      size_t best = diagonal + (a[i - 1] != b[j - 1]);
      if (above + 1 < best) best = above + 1;
      if (row[j - 1] + 1 < best) best = row[j - 1] + 1;
      row[j] = best;
      diagonal = above;
    }
  }
  return row[nb];
}

const char *hk_nearest_name(const char *wrong, const char *(*name)(const void *context, size_t k),
                            const void *context) {
  const char *best = NULL;
  size_t length = strlen(wrong), limit = length / 3 + 1, least = limit + 1;
  for (size_t k = 0;; k++) {
    const char *candidate = name(context, k);
    if (!candidate) return best;
    size_t distance = edit_distance(wrong, candidate);
    if (distance < least || (length > 2 && !best && strncmp(wrong, candidate, length) == 0)) {
      best = candidate;
      least = distance;
    }
  }
}
