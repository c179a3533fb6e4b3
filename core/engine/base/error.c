/* Errors. The first error set is the cause; later errors, its consequences, do not replace it. */
#include "core/engine/base/base.h"
#include "core/engine/text/text.h"

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
