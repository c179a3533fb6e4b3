/* Sorts rods into batches of four, longest first, so that little is padded, and fills the rows of their numbers.
 *
 * A joint stands for half of each of its edges, l = (L0 + L1)/2 where the stiffness is uniform; with half lengths in a
 * row, compliances add: 1/stiffness = L0/(2 B0) + L1/(2 B1). An edge between two pinned particles is a clamp: it lies
 * in the wall, does not deform, and counts for none of the length, so the joint at the wall is twice as stiff. That
 * makes the error of a clamped rod one of second order in the length of its edges. */
#include "plugins/common/rods/rod_rows.h"

#include <stdlib.h>
#include <string.h>

enum { LANES = HK_ROD_LANES };

/* ---- batches ---- */

typedef struct rod {
  uint32_t head, edges;
  bool ring, framed;
} rod;

static bool acts(const hk_view *view, const uint32_t *pair) {
  return !view->is_active || (view->is_active[pair[0]] && view->is_active[pair[1]]);
}

static double value_of(const hk_per_tuple *p, size_t e) { return p->count ? hk_tuple_value(p, e) : 0; }

static double second_of(const hk_rods *r, size_t e) { return value_of(r->EI2.count ? &r->EI2 : &r->EI, e); }

/* Whether the directions of cross sections matter to joint e. */
static bool has_sides(const hk_rods *r, size_t e) {
  return value_of(&r->EI, e) != second_of(r, e) || r->bent[0][e] != 0 || r->bent[1][e] != 0 ||
         value_of(&r->curvature, e) != 0 || (r->next[e] != HK_ROD_NONE && value_of(&r->curvature, r->next[e]) != 0);
}

static bool clamped(const hk_rods *r, const hk_view *view, size_t e) {
  const uint32_t *pair = hk_tuple(&r->edges, e);
  for (int c = 0; c < 2; c++)
    if (view->model->pin[pair[c]] != HK_PIN_FIXED && view->model->pin[pair[c]] != HK_PIN_PATH) return false;
  return true;
}

/* The rod that begins at edge `head`; `seen` is set for its edges. Twist acts where two clamps hold it, or a ring. */
static rod follow(const hk_rods *r, const hk_view *view, const bool *goes_on, uint32_t head, bool *seen) {
  rod p = {.head = head};
  size_t clamps = 0;
  bool twists = false;
  for (uint32_t e = head;; e = r->next[e]) {
    seen[e] = true;
    p.edges++;
    clamps += clamped(r, view, e);
    twists |= value_of(&r->GJ, e) > 0;
    p.framed |= goes_on[e] && has_sides(r, e);
    if (!goes_on[e]) break;
    if (r->next[e] == head) {
      p.ring = true;
      break;
    }
  }
  p.framed |= twists && (p.ring || clamps > 1 || r->spins.count > 0);
  return p;
}

/* Longest first; rings and rods with frames apart. */
static int by_kind(const void *a, const void *b) {
  const rod *p = a, *q = b;
  if (p->framed != q->framed) return p->framed ? 1 : -1;
  if (p->ring != q->ring) return p->ring ? 1 : -1;
  if (p->edges != q->edges) return p->edges < q->edges ? 1 : -1;
  return p->head < q->head ? -1 : 1;
}

static size_t find_rods(const hk_rods *r, const hk_view *view, rod *list, bool *seen, bool *goes_on, bool *entered) {
  size_t rods = 0;
  for (size_t e = 0; e < r->count; e++) {
    bool here = acts(view, hk_tuple(&r->edges, e));
    goes_on[e] = here && r->next[e] != HK_ROD_NONE && acts(view, hk_tuple(&r->edges, r->next[e]));
    seen[e] = !here;
    if (goes_on[e]) entered[r->next[e]] = true;
  }
  for (int rings = 0; rings < 2; rings++)
    for (uint32_t e = 0; e < r->count; e++) {
      if (seen[e] || (!rings && entered[e])) continue;
      rod p = follow(r, view, goes_on, e, seen);
      if (p.edges > 1) list[rods++] = p;
    }
  qsort(list, rods, sizeof *list, by_kind);
  return rods;
}

static bool same_batch(const rod *p, const rod *q) {
  return p->framed == q->framed && p->ring == q->ring && (!p->ring || p->edges == q->edges);
}

static void make_batches(hk_rods *r, const rod *list, size_t rods) {
  size_t row = 0, joints = 0;
  r->batches = 0;
  for (size_t k = 0; k < rods;) {
    hk_rod_batch *b = &r->batch[r->batches];
    *b = (hk_rod_batch){.first = row, .number = r->batches++, .edges = list[k].edges, .joint = joints};
    b->ring = list[k].ring, b->framed = list[k].framed;
    size_t begin = k;
    for (; k < rods && k < begin + LANES && same_batch(&list[begin], &list[k]); k++)
      b->count[k - begin] = list[k].edges, joints += list[k].edges - !list[k].ring;
    row += b->edges;
  }
  r->rows.edges = row;
  r->rows.nodes = row + r->batches;
}

/* ---- memory: one block each of numbers and of indices ---- */

static bool reserve(hk_rods *r) {
  const hk_host *host = r->host;
  hk_rod_rows *w = &r->rows;
  size_t edges = (w->edges + 1) * LANES, nodes = (w->nodes + 1) * LANES;
  double **const of_edges[] = {&w->bend[0], &w->bend[1], &w->twist, &w->rest[0], &w->rest[1], &w->rest_twist,
                               &w->held,    &w->t[0],    &w->t[1],  &w->t[2],    &w->inverse, &w->a[0],
                               &w->a[1],    &w->a[2],    &w->angle, &w->turn[0], &w->turn[1], &w->offset,
                               &w->pivot,   &w->lower,   &w->right, &w->column};
  enum { OF_EDGES = sizeof of_edges / sizeof *of_edges };
  host->release(host, w->bend[0]);
  host->release(host, w->x[0]);
  host->release(host, w->node);
  host->release(host, w->edge);
  double *numbers = host->allocate(host, OF_EDGES * edges * sizeof *numbers);
  double *places = host->allocate(host, 6 * nodes * sizeof *places);
  w->node = host->allocate(host, nodes * sizeof *w->node);
  w->edge = host->allocate(host, edges * sizeof *w->edge);
  for (size_t k = 0; k < OF_EDGES; k++) *of_edges[k] = numbers ? numbers + k * edges : NULL;
  for (size_t c = 0; c < 3; c++) {
    w->x[c] = places ? places + c * nodes : NULL;
    w->f[c] = places ? places + (c + 3) * nodes : NULL;
  }
  return numbers && places && w->node && w->edge;
}

/* ---- indices ---- */

static void place_rod(hk_rods *r, const hk_rod_batch *b, size_t lane, const rod *p) {
  hk_rod_rows *w = &r->rows;
  size_t edge = b->first * LANES + lane, node = (b->first + b->number) * LANES + lane;
  uint32_t e = p->head, at = hk_tuple(&r->edges, e)[0];
  w->node[node] = at;
  for (size_t k = 0; k < b->edges; k++) {
    bool there = k < p->edges;
    if (there) at = hk_tuple(&r->edges, e)[1];
    w->edge[edge + k * LANES] = there ? e : HK_ROD_NONE;
    w->node[node + (k + 1) * LANES] = at;
    if (k + 1 < p->edges) e = r->next[e];
  }
}

static void place_rods(hk_rods *r, const rod *list) {
  for (size_t k = 0; k < (r->rows.edges + 1) * LANES; k++) r->rows.edge[k] = HK_ROD_NONE;
  for (size_t q = 0, k = 0; q < r->batches; q++)
    for (size_t lane = 0; lane < LANES; lane++)
      if (r->batch[q].count[lane]) place_rod(r, &r->batch[q], lane, &list[k++]);
}

static bool find_shared(const hk_rods *r, bool *met) {
  for (size_t q = 0; q < r->batches; q++)
    for (size_t lane = 0; lane < LANES; lane++) {
      const hk_rod_batch *b = &r->batch[q];
      const uint32_t *node = r->rows.node + (b->first + b->number) * LANES + lane;
      for (size_t k = 0; b->count[lane] && k < b->count[lane] + !b->ring; k++) {
        if (met[node[k * LANES]]) return true;
        met[node[k * LANES]] = true;
      }
    }
  return false;
}

hk_status hk_rod_rows_build(hk_rods *r, const hk_view *view) {
  const hk_host *host = view->host;
  rod *list = host->allocate(host, (r->count + 1) * sizeof *list);
  bool *marks = host->allocate(host, 3 * r->count + view->n + 1);
  hk_rod_batch *batch = host->allocate(host, (r->count + 1) * sizeof *batch);
  double *sums = host->allocate(host, (r->count + 1) * sizeof *sums);
  uint8_t *pin = host->allocate(host, view->n + 1);
  uint32_t *node = host->allocate(host, 3 * (r->count + 1) * sizeof *node);
  double *weight = host->allocate(host, (r->count + 1) * sizeof *weight);
  hk_status status = HK_NO_MEMORY;
  host->release(host, r->batch);
  host->release(host, r->sums);
  host->release(host, r->pin);
  host->release(host, r->elements.node);
  host->release(host, r->elements.stiffness);
  r->elements = (hk_rod_elements){0, node, weight};
  r->batch = batch, r->sums = sums, r->pin = pin, r->pinned = view->n;
  r->batches = 0;
  if (list && marks && batch && sums && pin && node && weight) {
    size_t rods = find_rods(r, view, list, marks, marks + r->count, marks + 2 * r->count);
    make_batches(r, list, rods);
    if (reserve(r)) {
      place_rods(r, list);
      r->shared = find_shared(r, marks + 3 * r->count);
      hk_rod_rows_fill(r, view);
      status = HK_OK;
    }
  }
  host->release(host, list);
  host->release(host, marks);
  return status == HK_OK ? HK_OK : host->fail(host, status, "no memory for rods of %zu edges", r->count);
}

/* ---- numbers ---- */

/* half[2]: the half lengths that count. */
static double stiffness(double B0, double B1, const double half[2]) {
  if (!(B0 > 0) || !(B1 > 0)) return 0;
  return 1 / (half[0] / B0 + half[1] / B1);
}

static void fill_joint(hk_rods *r, size_t at, uint32_t e, uint32_t f, const bool clamp[2]) {
  hk_rod_rows *w = &r->rows;
  double half[2] = {r->rest_length[e] / 2, r->rest_length[f] / 2};
  if (clamp[0] && !clamp[1]) half[0] = 0;
  if (clamp[1] && !clamp[0]) half[1] = 0;
  w->bend[0][at] = stiffness(value_of(&r->EI, e), value_of(&r->EI, f), half);
  w->bend[1][at] = stiffness(second_of(r, e), second_of(r, f), half);
  w->twist[at] = stiffness(value_of(&r->GJ, e), value_of(&r->GJ, f), half);
  w->rest[0][at] = r->bent[0][e], w->rest[1][at] = r->bent[1][e], w->rest_twist[at] = r->twisted[e];
  if (!r->given) return;
  w->rest[0][at] = 2 * tan((value_of(&r->curvature, e) * half[0] + value_of(&r->curvature, f) * half[1]) / 2);
  w->rest[1][at] = 0;
  w->rest_twist[at] = value_of(&r->torsion, e) * half[0] + value_of(&r->torsion, f) * half[1];
}

static void clear_joint(hk_rod_rows *w, size_t at) {
  w->bend[0][at] = w->bend[1][at] = w->twist[at] = w->rest[0][at] = w->rest[1][at] = w->rest_twist[at] = 0;
}

static void fill_rod(hk_rods *r, const hk_view *view, hk_rod_batch *b, size_t lane) {
  hk_rod_rows *w = &r->rows;
  size_t at = b->first * LANES + lane, held = 0, count = b->count[lane];
  b->turned[lane] = HK_ROD_NONE;
  for (size_t k = 0; k < b->edges; k++, at += LANES) {
    uint32_t e = w->edge[at], f = k + 1 < count ? w->edge[at + LANES] : w->edge[b->first * LANES + lane];
    bool clamp[2] = {e != HK_ROD_NONE && clamped(r, view, e), e != HK_ROD_NONE && clamped(r, view, f)};
    w->offset[at] = 0;
    w->held[at] = e == HK_ROD_NONE || clamp[0] || r->spins.count > 0;
    held += clamp[0];
    if (clamp[0] && !b->ring) b->turned[lane] = (uint32_t)k;
    if (k < count && (k + 1 < count || b->ring))
      fill_joint(r, at, e, f, clamp);
    else
      clear_joint(w, at);
  }
  /* Without sides and clamps only differences of the angles matter. */
  bool sides = held > 0;
  for (size_t k = 0, q = b->first * LANES + lane; k < count; k++, q += LANES)
    sides |= w->bend[0][q] != w->bend[1][q] || w->rest[0][q] != 0 || w->rest[1][q] != 0;
  if (!sides) w->held[b->first * LANES + lane] = 1;
}

void hk_rod_rows_fill(hk_rods *r, const hk_view *view) {
  for (size_t q = 0; q < r->batches; q++)
    for (size_t lane = 0; lane < LANES; lane++) fill_rod(r, view, &r->batch[q], lane);
  for (size_t q = 0; q < r->batches; q++) r->batch[q].found = false;
  hk_rod_elements_fill(&r->elements, &r->rows, r->batch, r->batches);
  memcpy(r->pin, view->model->pin, view->n);
}
