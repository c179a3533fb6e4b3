/* Memory of a search for a surface, counted and limited, and the sentence for a value that no surface can have. */
#include "plugins/common/isosurface/grid_blocks.h"

#include <string.h>

hk_status hk_surface_allocate(hk_surface_work *w, void *array, size_t count, size_t size, const char *what) {
  size_t most = w->options->most_bytes ? w->options->most_bytes : SIZE_MAX;
  void *memory = NULL;
  if (count > (SIZE_MAX / 2 - w->bytes) / size || w->bytes + count * size > most)
    return w->host->fail(
        w->host, HK_NO_MEMORY,
        "isosurface: %zu %s need %.3g MB beside %.3g MB, and %.3g MB are allowed: take a larger spacing or a "
        "smaller box",
        count, what, 1e-6 * (double)count * (double)size, 1e-6 * (double)w->bytes, 1e-6 * (double)most);
  memory = w->host->allocate(w->host, count * size);
  if (!memory)
    return w->host->fail(w->host, HK_NO_MEMORY, "isosurface: no memory for %zu %s (%.3g MB): take a larger spacing",
                         count, what, 1e-6 * (double)count * (double)size);
  memcpy(array, &memory, sizeof memory);
  w->bytes += count * size;
  return HK_OK;
}

hk_status hk_surface_refuse(const hk_surface_work *w, const size_t i[3], double value) {
  double x[3];
  for (int c = 0; c < 3; c++) x[c] = hk_point_place(w, c, i[c] + 1);
  return w->host->fail(w->host, HK_NOT_FINITE,
                       "isosurface: the field is %g at (%g, %g, %g), point (%zu, %zu, %zu) of the grid: give a finite "
                       "number there, of at most 1e300 in size",
                       value, x[0], x[1], x[2], i[0], i[1], i[2]);
}
