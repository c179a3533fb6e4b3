#include "plugins/common/space/bvh.h"

#include <string.h>

static const hk_box nowhere = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

static void include(hk_box *b, const hk_box *other) {
  for (int c = 0; c < 3; c++) {
    b->low[c] = fmin(b->low[c], other->low[c]);
    b->high[c] = fmax(b->high[c], other->high[c]);
  }
}

static double centre(const hk_box *b, int c) { return b->low[c] + b->high[c]; } /* twice */

/* ---- building ---- */

/* By the centre along an axis, equal ones by number, so that the order does not depend on anything else. */
static bool before(const hk_box *box, int axis, uint32_t a, uint32_t b) {
  double ca = centre(&box[a], axis), cb = centre(&box[b], axis);
  return ca != cb ? ca < cb : a < b;
}

static void swap(uint32_t *a, uint32_t *b) {
  uint32_t kept = *a;
  *a = *b;
  *b = kept;
}

/* The k smallest first (Wirth 1976, Algorithms + Data Structures = Programs, 2.3.4). */
static void select_median(uint32_t *item, ptrdiff_t count, ptrdiff_t k, const hk_box *box, int axis) {
  for (ptrdiff_t low = 0, high = count - 1; low < high;) {
    uint32_t pivot = item[k];
    ptrdiff_t i = low, j = high;
    do {
      while (before(box, axis, item[i], pivot)) i++;
      while (before(box, axis, pivot, item[j])) j--;
      if (i <= j) swap(&item[i++], &item[j--]);
    } while (i <= j);
    if (j < k) low = i;
    if (k < i) high = j;
  }
}

static int longest_side(const hk_box *box, const uint32_t *item, size_t count) {
  double low[3], high[3];
  int axis = 0;
  for (int c = 0; c < 3; c++) {
    low[c] = INFINITY, high[c] = -INFINITY;
    for (size_t k = 0; k < count; k++) {
      low[c] = fmin(low[c], centre(&box[item[k]], c));
      high[c] = fmax(high[c], centre(&box[item[k]], c));
    }
    if (high[c] - low[c] > high[axis] - low[axis]) axis = c;
  }
  return axis;
}

static void divide(hk_bvh *t, const hk_box *box) {
  t->node[0] = (hk_bvh_node){nowhere, 0, (uint32_t)t->items};
  t->nodes = 1;
  for (size_t k = 0; k < t->nodes; k++) {
    hk_bvh_node *n = &t->node[k];
    if (n->count <= HK_BVH_LEAF) continue;
    uint32_t *item = t->order + n->first, half = n->count / 2;
    select_median(item, n->count, half, box, longest_side(box, item, n->count));
    t->node[t->nodes] = (hk_bvh_node){nowhere, n->first, half};
    t->node[t->nodes + 1] = (hk_bvh_node){nowhere, n->first + half, n->count - half};
    n->first = (uint32_t)t->nodes;
    n->count = 0;
    t->nodes += 2;
  }
}

static bool reserve(hk_bvh *t, const hk_host *host, size_t items) {
  if (items <= t->room) return true;
  hk_bvh_free(t, host);
  t->node = host->allocate(host, 2 * items * sizeof *t->node);
  t->order = host->allocate(host, items * sizeof *t->order);
  t->room = t->node && t->order ? items : 0;
  return t->room;
}

hk_status hk_bvh_build(hk_bvh *t, const hk_host *host, const hk_box *box, size_t items) {
  t->items = t->nodes = 0;
  if (!reserve(t, host, items)) return host->fail(host, HK_NO_MEMORY, "no memory for a tree of %zu boxes", items);
  if (!items) return HK_OK;
  t->items = items;
  for (size_t k = 0; k < items; k++) t->order[k] = (uint32_t)k;
  divide(t, box);
  hk_bvh_refit(t, box);
  t->built_cost = hk_bvh_cost(t);
  return HK_OK;
}

void hk_bvh_refit(hk_bvh *t, const hk_box *box) {
  for (size_t k = t->nodes; k-- > 0;) {
    hk_bvh_node *n = &t->node[k];
    n->box = nowhere;
    for (uint32_t q = 0; q < n->count; q++) include(&n->box, &box[t->order[n->first + q]]);
    for (uint32_t q = 0; n->count == 0 && q < 2; q++) include(&n->box, &t->node[n->first + q].box);
  }
}

void hk_bvh_free(hk_bvh *t, const hk_host *host) {
  host->release(host, t->node);
  host->release(host, t->order);
  *t = (hk_bvh){0};
}

static double surface(const hk_box *b) {
  double x = b->high[0] - b->low[0], y = b->high[1] - b->low[1], z = b->high[2] - b->low[2];
  return x * y + y * z + z * x;
}

double hk_bvh_cost(const hk_bvh *t) {
  double sum = 0;
  for (size_t k = 0; k < t->nodes; k++) sum += surface(&t->node[k].box);
  return t->nodes && surface(&t->node[0].box) > 0 ? sum / surface(&t->node[0].box) : (double)t->nodes;
}

/* ---- searches ---- */

void hk_bvh_overlaps(const hk_bvh *t, const hk_box *box, const hk_box *with, void (*visit)(void *, uint32_t),
                     void *context) {
  uint32_t stack[HK_BVH_DEPTH], top = 0;
  if (t->nodes) stack[top++] = 0;
  while (top) {
    const hk_bvh_node *n = &t->node[stack[--top]];
    if (!hk_box_overlap(&n->box, with)) continue;
    for (uint32_t q = 0; q < n->count; q++) {
      uint32_t item = t->order[n->first + q];
      if (hk_box_overlap(&box[item], with)) visit(context, item);
    }
    if (n->count) continue;
    stack[top++] = n->first + 1;
    stack[top++] = n->first;
  }
}

typedef struct below {
  uint32_t item;
  void (*visit)(void *, uint32_t, uint32_t);
  void *context;
} below;

static void visit_above(void *context, uint32_t other) {
  const below *b = context;
  if (other > b->item) b->visit(b->context, b->item, other);
}

void hk_bvh_pairs(const hk_bvh *t, const hk_box *box, void (*visit)(void *, uint32_t, uint32_t), void *context) {
  for (uint32_t i = 0; i < t->items; i++) {
    below b = {i, visit, context};
    hk_bvh_overlaps(t, box, &box[i], visit_above, &b);
  }
}

static double away2(const hk_box *b, const double p[3]) {
  double sum = 0;
  for (int c = 0; c < 3; c++) {
    double d = fmax(0, fmax(b->low[c] - p[c], p[c] - b->high[c]));
    sum += d * d;
  }
  return sum;
}

double hk_bvh_nearest(const hk_bvh *t, const double p[3], double best2,
                      double (*distance2)(void *, uint32_t, double best2), void *context) {
  struct {
    uint32_t node;
    double away2;
  } stack[HK_BVH_DEPTH];
  uint32_t top = 0;
  if (t->nodes) stack[top].node = 0, stack[top++].away2 = away2(&t->node[0].box, p);
  while (top) {
    top--;
    if (!(stack[top].away2 < best2)) continue;
    const hk_bvh_node *n = &t->node[stack[top].node];
    for (uint32_t q = 0; q < n->count; q++) best2 = fmin(best2, distance2(context, t->order[n->first + q], best2));
    if (n->count) continue;
    double a = away2(&t->node[n->first].box, p), b = away2(&t->node[n->first + 1].box, p);
    uint32_t nearer = a <= b ? 0 : 1;
    stack[top].node = n->first + 1 - nearer, stack[top++].away2 = fmax(a, b);
    stack[top].node = n->first + nearer, stack[top++].away2 = fmin(a, b);
  }
  return best2;
}
