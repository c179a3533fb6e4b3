/* Takes particles away that are in a box at the end of a step: the outlet of a tank, the edge of a scene. With a rate,
 * kg/s, it takes no more than that: by the time t the mass that is gone is at most rate (t - from), to half a particle,
 * and what the box did not hold is not made up for later. Particles that pins hold, that are of rigid bodies, or that
 * edges and triangles of the scene join, stay. The order of ids decides, so that frames are the same for any order in
 * memory and any number of threads. */
#include "core/plugin.h"

#include <string.h>

typedef struct drain {
  double low[3], high[3], rate, from, to;
  bool *stays; /* n */
  const hk_host *host;
  double taken, asked; /* kg: gone; what the rate would have taken, where that is less than there was */
  int64_t count;
} drain;

static const hk_param params[] = {
    {"low", "m", "lower corner of the box", .vector = HK_AT(drain, low), .flags = HK_REQUIRED},
    {"high", "m", "upper corner", .vector = HK_AT(drain, high), .flags = HK_REQUIRED},
    {"rate", "kg/s", "mass that is taken away, at most; left out: all that is in the box", .number = HK_AT(drain, rate),
     .limits = HK_WITHIN(0, 1e12), .flags = HK_OPTIONAL},
    {"from", "s", "time at which it opens", .number = HK_AT(drain, from)},
    {"to", "s", "time at which it closes; left out: never", .number = HK_AT(drain, to), .flags = HK_OPTIONAL},
    {0},
};

static const hk_field fields[] = {
    {"taken", .number = HK_AT(drain, taken)},
    {"asked", .number = HK_AT(drain, asked)},
    {"count", .integer = HK_AT(drain, count)},
    {0},
};

static void keep(bool *stays, const hk_tuples *joined) {
  for (size_t k = 0; k < joined->count * joined->arity; k++) stays[joined->index[k]] = true;
}

static hk_status topology(void *self, const hk_view *view) {
  drain *d = self;
  const hk_model *m = view->model;
  d->host->release(d->host, d->stays);
  d->stays = d->host->allocate(d->host, view->n + 1);
  if (!d->stays) return d->host->fail(d->host, HK_NO_MEMORY, "no memory for %zu particles", view->n);
  for (size_t i = 0; i < view->n; i++) d->stays[i] = m->pin[i] != HK_FREE || (m->inside && m->inside[i]);
  keep(d->stays, &m->edges);
  keep(d->stays, &m->triangles);
  return HK_OK;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  drain *d = self;
  d->host = host;
  for (int c = 0; c < 3; c++)
    if (!(d->high[c] >= d->low[c]))
      return host->fail(host, HK_BAD_PARAM,
                        "high: %g m is below low, %g m, along %c, so that nothing is in the box: give its upper corner",
                        d->high[c], d->low[c], "xyz"[c]);
  if (d->to <= d->from) return host->fail(host, HK_BAD_PARAM, "to: %g s is not after from: %g s", d->to, d->from);
  return topology(self, view);
}

static bool is_in(const drain *d, const double x[3]) {
  bool in = true;
  for (int c = 0; c < 3; c++) in &= x[c] >= d->low[c] && x[c] <= d->high[c];
  return in;
}

static hk_status emit(void *self, const hk_view *view, double h, hk_population *population) {
  drain *d = self;
  double begin = fmax(view->t - h, d->from), end = isnan(d->to) ? view->t : fmin(view->t, d->to);
  hk_status status = HK_OK;
  bool limited = !isnan(d->rate), enough = false;
  if (!(end > begin)) return HK_OK;
  if (limited) d->asked += d->rate * (end - begin);
  for (size_t k = 0; k < view->n && status == HK_OK && !enough; k++) {
    size_t i = hk_model_nth(view->model, k);
    double mass = view->model->mass[i];
    if (d->stays[i] || !is_in(d, view->x + 3 * i)) continue;
    enough = limited && d->taken + mass / 2 > d->asked;
    if (enough) continue;
    status = population->remove(population, (uint32_t)i);
    d->taken += mass;
    d->count++;
  }
  if (limited && !enough) d->asked = d->taken; /* the box is empty */
  return status;
}

static const hk_source source = {.size = sizeof(hk_source), .emit = emit, .flags = HK_AFTER_STEPS};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_SOURCE,
    .name = "drain",
    .summary = "takes particles away that are in a box, all of them or up to so many kg/s",
    .instance_size = sizeof(drain),
    .params = params,
    .fields = fields,
    .create = create,
    .topology = topology,
    .source = &source,
};
