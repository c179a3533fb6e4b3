#include "plugins/common/sph/sph_pairs.h"

#include "plugins/common/space/reserve.h"

/* `into` NULL: counts them. */
static size_t list_pairs(const hk_sph *s, const hk_neighbour_rows *rows, hk_sph_acts acts, const void *self,
                         uint32_t (*into)[2]) {
  size_t count = 0;
  for (size_t i = 0; i < rows->n; i++)
    for (size_t e = rows->row_start[i]; e < rows->row_start[i + 1]; e++) {
      uint32_t j = rows->other[e];
      if (j < i || !(s->point[i][3] > 0 && s->point[j][3] > 0) || !acts(self, i, j)) continue;
      if (into) into[count][0] = (uint32_t)i, into[count][1] = j;
      count++;
    }
  return count;
}

void hk_sph_pairs_name(hk_sph_pairs *p, hk_sph *s, const hk_view *view, hk_sph_acts acts, const void *self,
                       hk_pattern *into) {
  hk_neighbour_rows rows;
  p->number = 0;
  p->count = 0;
  p->failed = hk_sph_begin(s, view, &rows);
  if (p->failed != HK_OK) return;
  size_t count = list_pairs(s, &rows, acts, self, NULL);
  p->failed = hk_reserve(s->host, &p->pair, &p->room, count, sizeof *p->pair);
  if (p->failed != HK_OK) return;
  p->count = list_pairs(s, &rows, acts, self, p->pair);
  p->number = rows.number;
  for (size_t k = 0; k < p->count; k++)
    for (int e = 0; e < 4; e++) into->block(into, p->pair[k][e / 2], p->pair[k][e % 2]);
}

hk_status hk_sph_pairs_update(hk_sph *s, uint64_t number, const hk_view *from, const double *x_to,
                              bool *pattern_changed) {
  hk_neighbour_rows rows;
  hk_status status = hk_sph_update(s, from);
  if (status == HK_OK) status = s->service->rows(s->service->self, from, x_to, &rows);
  *pattern_changed = status == HK_OK && rows.number != number;
  return status;
}

void hk_sph_pair_add(double *blocks, const size_t slot[4], const double B[9]) {
  for (int e = 0; e < 4; e++)
    for (int q = 0; q < 9; q++) blocks[9 * slot[e] + (size_t)q] += e == 0 || e == 3 ? B[q] : -B[q];
}
