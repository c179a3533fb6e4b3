/* The arguments of a function that a plugin takes of the script, as the text of its parameter names them: "function(t,
 * x, y, z, id) -> potential" has five. */
#include "core/numerics/functions/functions.h"

size_t hk_function_arguments(const hk_param *p) {
  size_t count = 1;
  for (const char *c = p->signature; *c && *c != ')'; c++) count += *c == ',';
  return count;
}
