#include "plugins/common/contact/impulses/awake.h"

#include "plugins/common/space/reserve.h"

#include <string.h>

hk_status hk_awake_open(hk_awake *a, const hk_host *host, size_t n) {
  a->host = host;
  a->n = n;
  host->release(host, a->start);
  a->start = host->allocate(host, (n + 2) * sizeof *a->start);
  return a->start ? HK_OK : host->fail(host, HK_NO_MEMORY, "no memory for %zu particles", n);
}

static hk_status make_room(hk_awake *a, size_t count) {
  const hk_host *host = a->host;
  if (count >= UINT32_MAX / 4) return host->fail(host, HK_FAILED, "%zu impacts are more than can be numbered", count);
  a->words = count / 64 + 1;
  hk_status status = hk_reserve(host, &a->impact, &a->room, 4 * count, sizeof *a->impact);
  return status == HK_OK ? hk_reserve(host, &a->word, &a->word_room, a->words, sizeof *a->word) : status;
}

static bool moves(const hk_impact *k, int i, const double *inverse_mass) {
  return k->mobility > 0 && inverse_mass[k->pair.vertex[i]] > 0;
}

/* On return start[i] is where the impacts of particle i begin, and they rise. */
hk_status hk_awake_list(hk_awake *a, const hk_impact *impact, size_t count, const double *inverse_mass) {
  hk_status status = make_room(a, count);
  if (status != HK_OK) return status;
  hk_awake_none(a);
  memset(a->start, 0, (a->n + 2) * sizeof *a->start);
  for (size_t e = 0; e < count; e++)
    for (int i = 0; i < 4; i++) a->start[impact[e].pair.vertex[i] + 2] += moves(&impact[e], i, inverse_mass);
  for (size_t i = 0; i < a->n; i++) a->start[i + 2] += a->start[i + 1];
  for (size_t e = 0; e < count; e++)
    for (int i = 0; i < 4; i++)
      if (moves(&impact[e], i, inverse_mass)) a->impact[a->start[impact[e].pair.vertex[i] + 1]++] = (uint32_t)e;
  return HK_OK;
}

void hk_awake_none(hk_awake *a) { memset(a->word, 0, a->words * sizeof *a->word); }
