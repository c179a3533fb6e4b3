/* Sentences that are put together in one buffer. */
#include "core/text/text.h"

#include <string.h>

void hk_text_append(char *text, size_t size, const char *separator, const char *format, va_list arguments) {
  size_t used = strlen(text);
  if (used && used + strlen(separator) < size) used += (size_t)snprintf(text + used, size - used, "%s", separator);
  vsnprintf(text + used, size - used, format, arguments);
}
