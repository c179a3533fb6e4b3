#include "plugins/common/mac_grid/carried.h"

static void mark(const hk_tuples *t, bool *out) {
  for (size_t k = 0; k < t->count * t->arity; k++) out[t->index[k]] = true;
}

/* What slides on a pin would be left out without a word. */
static hk_status check_pin(const hk_host *host, const hk_model *model, uint32_t i) {
  if (model->pin[i] != HK_PIN_LINE && model->pin[i] != HK_PIN_PLANE) return HK_OK;
  return host->fail(host, HK_BAD_PARAM,
                    "particles: particle %u slides on a pin, of which the grid knows nothing: leave the pin out and, "
                    "to stay in a plane, give `low` and `high` the same number along its normal",
                    model->id[i]);
}

hk_status hk_carried_find(const hk_host *host, const hk_view *view, const hk_tuples *listed, const hk_tuples *without,
                          uint32_t *index, size_t *count) {
  const hk_model *m = view->model;
  size_t most = listed->count ? listed->count : view->n;
  bool *out = host->allocate(host, view->n + 1);
  hk_status status = out ? HK_OK : host->fail(host, HK_NO_MEMORY, "no memory for %zu particles", view->n);
  *count = 0;
  if (status == HK_OK && without) mark(without, out);
  if (status == HK_OK && !listed->count) {
    mark(&m->edges, out);
    mark(&m->triangles, out);
  }
  for (size_t k = 0; k < most && status == HK_OK; k++) {
    uint32_t i = listed->count ? *hk_tuple(listed, k) : (uint32_t)k;
    if (out[i]) continue;
    status = check_pin(host, m, i);
    if (m->pin[i] == HK_FREE && m->inverse_mass[i] > 0 && !(m->inside && m->inside[i])) index[(*count)++] = i;
  }
  host->release(host, out);
  return status;
}
