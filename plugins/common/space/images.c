/* See images.h. The nearest image of j is at most half a length from i along each axis, so images within the smaller of
 * that and of the reach, outside of the faces, have it; axis by axis, so that those across edges and corners come from
 * those across faces (Allen and Tildesley 1987, section 1.5). Where the reach exceeds half of a length a row finds j
 * more than once, or i itself. */
#include "plugins/common/space/images.h"
#include "plugins/common/space/reserve.h"

#include <float.h>
#include <string.h>

enum { GRAIN = 512 };

static const double margin = 1e-9; /* far above the rounding of places in the box */

static hk_status make_room(hk_images *m, const hk_host *host, size_t count) {
  if (count <= m->room) return HK_OK;
  size_t room = m->room + m->room / 2;
  if (room < count) room = count;
  double *x = room < UINT32_MAX ? host->allocate(host, 3 * room * sizeof *x) : NULL;
  uint32_t *of = x ? host->allocate(host, room * sizeof *of) : NULL;
  if (!of) return host->fail(host, HK_NO_MEMORY, "no memory for the images of %zu particles", m->n);
  if (m->count > 0) { /* or there is nothing yet to copy from */
    memcpy(x, m->x, 3 * m->count * sizeof *x);
    memcpy(of, m->of, m->count * sizeof *of);
  }
  host->release(host, m->x);
  host->release(host, m->of);
  m->x = x, m->of = of, m->room = room;
  return HK_OK;
}

/* Rounding may leave a place on the upper face. */
static void bring_in(hk_images *m, const hk_periodic_box *box, const double *x) {
  for (size_t i = 0; i < m->n; i++) {
    m->of[i] = (uint32_t)i;
    for (size_t c = 0; c < 3; c++) {
      double length = box->high[c] - box->low[c], at = x[3 * i + c];
      m->x[3 * i + c] = box->repeats[c] ? at - length * floor((at - box->low[c]) / length) : at;
    }
  }
}

/* Along axis c, of what there is so far. */
static hk_status add_images(hk_images *m, const hk_host *host, const hk_periodic_box *box, size_t c, double reach) {
  double length = box->high[c] - box->low[c], depth = fmin(reach, length / 2) + margin * length;
  for (size_t k = 0, before = m->count; k < before; k++)
    for (int side = -1; side <= 1; side += 2) {
      double at = m->x[3 * k + c], gap = side < 0 ? box->high[c] - at : at - box->low[c];
      if (!(gap < depth)) continue;
      hk_status status = make_room(m, host, m->count + 1);
      if (status != HK_OK) return status;
      double *to = m->x + 3 * m->count;
      memcpy(to, m->x + 3 * k, 3 * sizeof *to);
      to[c] += side * length;
      m->of[m->count++] = m->of[k];
    }
  return HK_OK;
}

/* ---- rows ---- */

typedef struct folding {
  const hk_images *images;
  hk_cell_list *list;
} folding;

/* Images become their points; the rest of a row rises already, so that insertion is short. */
static void fold_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const folding *f = context;
  (void)chunk;
  for (size_t i = begin; i < end; i++) {
    uint32_t *row = f->list->other + f->list->row_start[i];
    size_t count = f->list->row_start[i + 1] - f->list->row_start[i];
    for (size_t k = 0; k < count; k++) {
      uint32_t value = f->images->of[row[k]];
      size_t at = k;
      for (; at > 0 && row[at - 1] > value; at--) row[at] = row[at - 1];
      row[at] = value;
    }
  }
}

/* Each j once, and not i. */
static void close_up(hk_cell_list *l, size_t n) {
  size_t to = 0;
  for (size_t i = 0; i < n; i++) {
    size_t from = l->row_start[i], begin = to;
    l->row_start[i] = begin;
    for (size_t e = from; e < l->row_start[i + 1]; e++)
      if (l->other[e] != i && (to == begin || l->other[to - 1] != l->other[e])) l->other[to++] = l->other[e];
  }
  l->row_start[n] = to;
}

/* Far from the box, places in it are known to the rounding of the position alone. */
static double widest(const hk_periodic_box *box, const double *x, size_t n) {
  double most = 0;
  for (size_t e = 0; e < 3 * n; e++)
    if (box->repeats[e % 3]) most = fmax(most, fabs(x[e]));
  return 8 * DBL_EPSILON * most;
}

hk_status hk_images_rows(hk_images *m, hk_cell_list *l, const hk_host *host, const hk_periodic_box *box,
                         const double *x, size_t n, double reach) {
  m->n = n;
  m->count = 0;
  hk_status status = make_room(m, host, n + 1);
  if (status != HK_OK) return status;
  m->count = n;
  if (reach > 0) reach += widest(box, x, n);
  bring_in(m, box, x);
  bool twice = false;
  for (size_t c = 0; c < 3 && status == HK_OK && reach > 0; c++) {
    if (!box->repeats[c]) continue;
    twice |= box->high[c] - box->low[c] < 2.1 * reach;
    status = add_images(m, host, box, c, reach);
  }
  if (status == HK_OK) status = hk_cell_list_build_first(l, host, m->x, m->count, n, reach);
  if (status != HK_OK) return status;
  l->n = n;
  folding f = {m, l};
  host->parallel_for(host, n, GRAIN, fold_chunk, &f);
  if (twice) close_up(l, n);
  return HK_OK;
}
