/* Sentences that are put together in one buffer. */
#include "core/engine/text/text.h"

#include <string.h>

const char *hk_known_ids(char text[64], size_t n) {
  if (n == 0) return strcpy(text, "the scene has none yet");
  snprintf(text, 64, n == 1 ? "its only id is %zu" : "ids are 1 to %zu", n);
  return text;
}

void hk_text_append(char *text, size_t size, const char *separator, const char *format, va_list arguments) {
  size_t used = strlen(text);
  if (used && used + strlen(separator) < size) used += (size_t)snprintf(text + used, size - used, "%s", separator);
  vsnprintf(text + used, size - used, format, arguments);
}
