/* Averages at places, by the lists of the particles that reach a block. */
#include "plugins/common/particle_surface/particle_average.h"
#include "plugins/common/particle_surface/particle_field.h"

#include <string.h>

enum { GRAIN = 256 };

typedef struct task {
  const hk_particle_field *field;
  const hk_particle_values *values;
  const double (*place)[3];
  double *to;
} task;

static void average_at(const task *t, const double x[3], double *to) {
  const hk_particle_field *f = t->field;
  size_t block = hk_particle_field_block(f, x), width = t->values->width;
  double sum = 0, scale = 1 / (f->o.reach * f->o.reach);
  memset(to, 0, width * sizeof *to);
  for (size_t n = f->start[block]; n < f->start[block + 1]; n++) {
    const double *p = f->x[f->list[n]], *value = t->values->value + width * f->list[n];
    double d[3] = {x[0] - p[0], x[1] - p[1], x[2] - p[2]};
    double q = 1 - (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) * scale, w = q > 0 ? q * q * q : 0;
    sum += w;
    for (size_t c = 0; c < width && w > 0; c++) to[c] += w * value[c];
  }
  for (size_t c = 0; c < width && sum > 0; c++) to[c] /= sum;
}

static void average_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  (void)chunk;
  for (size_t k = begin; k < end; k++) average_at(t, t->place[k], t->to + t->values->width * k);
}

hk_status hk_particle_average(const hk_host *host, const hk_particle_values *values,
                              const hk_particle_surface_options *options, const double (*place)[3], size_t count,
                              double *to) {
  hk_particle_field f = {.host = host, .x = values->x, .n = values->n, .o = *options};
  task t = {&f, values, place, to};
  if (count == 0) return HK_OK;
  hk_status status = hk_particle_field_open(&f);
  if (status == HK_OK) host->parallel_for(host, count, GRAIN, average_chunk, &t);
  hk_particle_field_close(&f);
  return status;
}
