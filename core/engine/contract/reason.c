/* The sentence that says what is wrong. */
#include "core/engine/contract/contract.h"

#include <stdio.h>

bool hk_wrong(hk_reason_text *reason, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(reason->text, sizeof reason->text, format, arguments);
  va_end(arguments);
  return false;
}
