#include "plugins/common/space/bvh.h"

#include <float.h>
#include <string.h>

enum { GRAIN = 256 };

/* ---- building ---- */

/* An item and the centre of its box, twice; equal ones come by number, so that the order depends on nothing else. */
typedef struct hk_bvh_key {
  float centre[3];
  uint32_t item;
} key;

static bool before(const key *a, const key *b, int axis) {
  return a->centre[axis] != b->centre[axis] ? a->centre[axis] < b->centre[axis] : a->item < b->item;
}

static void swap(key *a, key *b) {
  key kept = *a;
  *a = *b;
  *b = kept;
}

/* The k smallest first (Wirth 1976, Algorithms + Data Structures = Programs, 2.3.4). */
static void select_median(key *item, ptrdiff_t count, ptrdiff_t k, int axis) {
  for (ptrdiff_t low = 0, high = count - 1; low < high;) {
    key pivot = item[k];
    ptrdiff_t i = low, j = high;
    do {
      while (before(&item[i], &pivot, axis)) i++;
      while (before(&pivot, &item[j], axis)) j--;
      if (i <= j) swap(&item[i++], &item[j--]);
    } while (i <= j);
    if (j < k) low = i;
    if (k < i) high = j;
  }
}

static int longest_side(const key *item, size_t count) {
  float low[3], high[3];
  int axis = 0;
  for (int c = 0; c < 3; c++) {
    low[c] = INFINITY, high[c] = -INFINITY;
    for (size_t k = 0; k < count; k++) {
      low[c] = item[k].centre[c] < low[c] ? item[k].centre[c] : low[c];
      high[c] = item[k].centre[c] > high[c] ? item[k].centre[c] : high[c];
    }
    if (high[c] - low[c] > high[axis] - low[axis]) axis = c;
  }
  return axis;
}

static void split(key *item, size_t count, size_t first) {
  if (count > first) select_median(item, (ptrdiff_t)count, (ptrdiff_t)first, longest_side(item, count));
}

typedef struct task {
  hk_bvh *tree;
  const hk_box *box;
  unsigned level;
  size_t part; /* items of a child of this level */
} task;

/* Blocks of four parts, into these. */
static void split_blocks(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  (void)chunk;
  for (size_t block = begin; block < end; block++) {
    size_t first = 4 * t->part * block, rest = t->tree->items - first, half = 2 * t->part;
    size_t count = rest < 2 * half ? rest : 2 * half;
    key *item = t->tree->key + first;
    split(item, count, half);
    split(item, count < half ? count : half, t->part);
    if (count > half) split(item + half, count - half, t->part);
  }
}

static void take_centres(hk_bvh *t, const hk_box *box) {
  double low[3], high[3];
  for (int c = 0; c < 3; c++) {
    low[c] = INFINITY, high[c] = -INFINITY;
    for (size_t k = 0; k < t->items; k++) low[c] = fmin(low[c], box[k].low[c]), high[c] = fmax(high[c], box[k].high[c]);
    t->centre[c] = low[c] / 2 + high[c] / 2;
  }
  for (size_t k = 0; k < t->items; k++) {
    t->key[k].item = (uint32_t)k;
    for (int c = 0; c < 3; c++)
      t->key[k].centre[c] = (float)(box[k].low[c] - t->centre[c] + (box[k].high[c] - t->centre[c]));
  }
}

/* Each level has a node for every four of the one below. */
static void number_nodes(hk_bvh *t) {
  t->levels = 0;
  t->nodes = 0;
  for (size_t below = t->items; t->items && (t->levels < 2 || below > 1);) {
    below = (below + 3) / 4;
    t->level[t->levels++] = t->nodes;
    t->nodes += below;
  }
  t->level[t->levels] = t->nodes;
}

static bool reserve(hk_bvh *t, const hk_host *host, size_t items) {
  if (items <= t->room) return true;
  hk_bvh_free(t, host);
  t->node = host->allocate(host, (items / 2 + HK_BVH_LEVELS) * sizeof *t->node);
  t->order = host->allocate(host, items * sizeof *t->order);
  t->key = host->allocate(host, items * sizeof *t->key);
  t->room = t->node && t->order && t->key ? items : 0;
  return t->room;
}

hk_status hk_bvh_build(hk_bvh *t, const hk_host *host, const hk_box *box, size_t items) {
  task split_task = {.tree = t};
  t->items = t->nodes = t->levels = 0;
  if (!reserve(t, host, items)) return host->fail(host, HK_NO_MEMORY, "no memory for a tree of %zu boxes", items);
  if (!items) return HK_OK;
  t->items = items;
  number_nodes(t);
  take_centres(t, box);
  for (unsigned l = t->levels; l-- > 1;) {
    split_task.part = (size_t)1 << 2 * l;
    host->parallel_for(host, t->level[l + 1] - t->level[l], 1, split_blocks, &split_task);
  }
  for (size_t k = 0; k < items; k++) t->order[k] = t->key[k].item;
  hk_bvh_refit(t, host, box);
  t->built_cost = hk_bvh_cost(t);
  return HK_OK;
}

void hk_bvh_free(hk_bvh *t, const hk_host *host) {
  host->release(host, t->node);
  host->release(host, t->order);
  host->release(host, t->key);
  *t = (hk_bvh){0};
}

/* ---- boxes ---- */

static const double largest = FLT_MAX / 4; /* beyond it, infinity, but never on the inner side */

static float below(double x) {
  float f = (float)fmin(x, largest);
  return f - (fabsf(f) * FLT_EPSILON + FLT_MIN);
}

static float above(double x) { return -below(-x); }

static void take_item(hk_bvh_node *n, int s, const hk_bvh *t, const hk_box *b) {
  for (int c = 0; c < 3; c++) {
    n->low[c][s] = b ? below(b->low[c] - t->centre[c]) : INFINITY;
    n->high[c][s] = b ? above(b->high[c] - t->centre[c]) : -INFINITY;
  }
}

static void fit_items(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  (void)chunk;
  for (size_t j = begin; j < end; j++)
    for (size_t s = 0; s < 4; s++)
      take_item(&t->tree->node[j], (int)s, t->tree,
                4 * j + s < t->tree->items ? &t->box[t->tree->order[4 * j + s]] : NULL);
}

static float least(const float a[4]) {
  float p = a[0] < a[1] ? a[0] : a[1], q = a[2] < a[3] ? a[2] : a[3];
  return p < q ? p : q;
}

static float most(const float a[4]) {
  float p = a[0] > a[1] ? a[0] : a[1], q = a[2] > a[3] ? a[2] : a[3];
  return p > q ? p : q;
}

static void fit_nodes(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  const size_t *level = t->tree->level + t->level;
  (void)chunk;
  for (size_t j = begin; j < end; j++)
    for (size_t s = 0; s < 4; s++) {
      hk_bvh_node *n = &t->tree->node[level[0] + j], *child = &t->tree->node[level[-1] + 4 * j + s];
      bool there = level[-1] + 4 * j + s < level[0];
      for (int c = 0; c < 3; c++) {
        n->low[c][s] = there ? least(child->low[c]) : INFINITY;
        n->high[c][s] = there ? most(child->high[c]) : -INFINITY;
      }
    }
}

void hk_bvh_refit(hk_bvh *t, const hk_host *host, const hk_box *box) {
  for (unsigned l = 0; l < t->levels; l++) {
    task fit = {.tree = t, .box = box, .level = l};
    host->parallel_for(host, t->level[l + 1] - t->level[l], GRAIN, l ? fit_nodes : fit_items, &fit);
  }
}

static double surface(double x, double y, double z) { return x >= 0 ? x * y + y * z + z * x : 0; }

double hk_bvh_cost(const hk_bvh *t) {
  double sum = 0, side[3];
  if (!t->nodes) return 0;
  for (size_t k = t->level[t->levels > 1]; k < t->nodes; k++) {
    const hk_bvh_node *n = &t->node[k];
    for (int s = 0; s < 4; s++)
      sum += surface(n->high[0][s] - n->low[0][s], n->high[1][s] - n->low[1][s], n->high[2][s] - n->low[2][s]);
  }
  for (int c = 0; c < 3; c++) side[c] = most(t->node[t->nodes - 1].high[c]) - least(t->node[t->nodes - 1].low[c]);
  double root = surface(side[0], side[1], side[2]);
  return root > 0 ? sum / root : (double)t->nodes;
}

/* ---- searches ---- */

/* Finite, so that children that are none are never hit. */
hk_bvh_query hk_bvh_ask(const hk_bvh *t, const hk_box *b) {
  hk_bvh_query q;
  for (int c = 0; c < 3; c++) {
    q.low[c] = fmaxf(below(b->low[c] - t->centre[c]), -FLT_MAX);
    q.high[c] = fminf(above(b->high[c] - t->centre[c]), FLT_MAX);
  }
  return q;
}

void hk_bvh_walk_begin(hk_bvh_walk *w, const hk_bvh *t, const hk_bvh_query *with, bool items) {
  w->tree = t;
  w->with = *with;
  w->last = items ? 0 : 1;
  w->top = t->levels ? 1 : 0;
  w->stack[0] = 0;
  w->level[0] = (unsigned char)(t->levels - 1);
}

size_t hk_bvh_walk_on(hk_bvh_walk *w, uint32_t found[HK_BVH_MOST]) {
  const hk_bvh *t = w->tree;
  const hk_bvh_query with = w->with;
  size_t count = 0;
  while (w->top && count + 4 <= HK_BVH_MOST) {
    uint32_t j = w->stack[--w->top];
    unsigned l = w->level[w->top];
    for (unsigned hits = hk_bvh_hits(&t->node[t->level[l] + j], &with); hits; hits &= hits - 1) {
      uint32_t child = 4 * j + (uint32_t)__builtin_ctz(hits);
      if (l == w->last) {
        found[count++] = child;
        continue;
      }
      w->stack[w->top] = child;
      w->level[w->top++] = (unsigned char)(l - 1);
    }
  }
  return count;
}

void hk_bvh_overlaps(const hk_bvh *t, const hk_box *box, const hk_box *with, void (*visit)(void *, uint32_t),
                     void *context) {
  hk_bvh_walk walk;
  uint32_t found[HK_BVH_MOST];
  hk_bvh_query query = hk_bvh_ask(t, with);
  hk_bvh_walk_begin(&walk, t, &query, true);
  for (size_t count; (count = hk_bvh_walk_on(&walk, found)) > 0;)
    for (size_t k = 0; k < count; k++)
      if (hk_box_overlap(&box[t->order[found[k]]], with)) visit(context, t->order[found[k]]);
}

static double away2(const hk_bvh_node *n, size_t s, const double p[3]) {
  double sum = 0;
  for (int c = 0; c < 3; c++) {
    double d = fmax(0, fmax((double)n->low[c][s] - p[c], p[c] - (double)n->high[c][s]));
    sum += d * d;
  }
  return sum;
}

typedef struct candidate {
  uint32_t node;
  unsigned level;
  double away2;
} candidate;

/* The children of a node below `best2`, farthest first. */
static unsigned push_children(const hk_bvh *t, const candidate *from, const double p[3], double best2, candidate *stack,
                              unsigned top) {
  const hk_bvh_node *n = &t->node[t->level[from->level] + from->node];
  unsigned bottom = top;
  for (uint32_t s = 0; s < 4; s++) {
    candidate child = {4 * from->node + s, from->level - 1, away2(n, s, p)};
    if (!(child.away2 < best2)) continue;
    unsigned to = top++;
    for (; to > bottom && stack[to - 1].away2 < child.away2; to--) stack[to] = stack[to - 1];
    stack[to] = child;
  }
  return top;
}

double hk_bvh_nearest(const hk_bvh *t, const double p[3], double best2,
                      double (*distance2)(void *, uint32_t, double best2), void *context) {
  candidate stack[HK_BVH_STACK + 4];
  const double at[3] = {p[0] - t->centre[0], p[1] - t->centre[1], p[2] - t->centre[2]};
  unsigned top = 0;
  if (t->levels) stack[top++] = (candidate){0, t->levels - 1, 0};
  while (top) {
    candidate from = stack[--top];
    if (!(from.away2 < best2)) continue;
    if (from.level == UINT32_MAX) { /* below the lowest: an item */
      best2 = fmin(best2, distance2(context, t->order[from.node], best2));
      continue;
    }
    top = push_children(t, &from, at, best2, stack, top);
  }
  return best2;
}
