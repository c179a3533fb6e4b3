/* Warnings of a run: each text is recorded and printed once. */
#include "core/engine/base/base.h"
#include "core/engine/text/text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void hk_warn(hk_warnings *w, const char *format, ...) {
  char text[1024], raw[1024];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(raw, sizeof raw, format, arguments);
  va_end(arguments);
  hk_plain_copy(text, sizeof text, raw);
  for (size_t k = 0; k < w->count; k++)
    if (strcmp(w->text[k], text) == 0) return;
  char *copy = hk_string_copy(text), **grown = realloc(w->text, (w->count + 1) * sizeof *grown);
  if (grown) w->text = grown;
  if (grown && copy)
    w->text[w->count++] = copy;
  else
    free(copy);
  if (!w->silent) fprintf(stderr, "hooke: warning: %s\n", text);
}

void hk_warnings_clear(hk_warnings *w) {
  for (size_t k = 0; k < w->count; k++) free(w->text[k]);
  free(w->text);
  *w = (hk_warnings){0};
}
