#include "plugins/common/surfaces/surface_search.h"

#include <string.h>

enum { GRAIN = 2048, ROWS = 256 };

/* Of coordinates, radii and reach: eight times what rounds when boxes are made and compared. */
static const double slack = 0x1p-50;
/* Searches visit nodes in proportion to the cost of the tree, and building takes as long as some ten searches. */
static const double spread = 1.5;

/* ---- memory ---- */

static size_t chunks_of(size_t n) { return (n + GRAIN - 1) / GRAIN; }

hk_status hk_surface_search_open(hk_surface_search *s, const hk_host *host, const hk_surface_lists *lists,
                                 const hk_model *model) {
  size_t n = model->n;
  hk_surface_search_free(s, host);
  *s = (hk_surface_search){.lists = lists, .model = model, .rows.record_size = sizeof(hk_item_pair)};
  s->swept = host->allocate(host, n * sizeof *s->swept);
  s->box = host->allocate(host, lists->items * sizeof *s->box);
  s->order = host->allocate(host, lists->items * sizeof *s->order);
  s->held = host->allocate(host, n * sizeof *s->held);
  s->lost = host->allocate(host, chunks_of(lists->mesh.points) * sizeof *s->lost);
  if (s->swept && s->box && s->order && s->held && s->lost) return HK_OK;
  hk_surface_search_free(s, host);
  return host->fail(host, HK_NO_MEMORY, "no memory for the boxes of %zu surfaces", lists->items);
}

void hk_surface_search_free(hk_surface_search *s, const hk_host *host) {
  void *memory[] = {s->swept, s->box, s->order, s->held, s->lost};
  for (size_t k = 0; k < sizeof memory / sizeof *memory; k++) host->release(host, memory[k]);
  hk_bvh_free(&s->tree, host);
  hk_gather_free(&s->rows, host);
  *s = (hk_surface_search){0};
}

/* ---- what can move ---- */

static bool is_held(const hk_surface_search *s, const hk_surface_item *item) {
  return s->held[item->vertex[0]] && s->held[item->vertex[1]] && s->held[item->vertex[2]];
}

bool hk_surface_search_pins_kept(const hk_surface_search *s) {
  const hk_surface_mesh *m = &s->lists->mesh;
  bool kept = s->ordered;
  for (size_t k = 0; k < m->points; k++) kept &= (s->model->inverse_mass[m->point[k]] == 0) == s->held[m->point[k]];
  return kept;
}

static void order_items(hk_surface_search *s) {
  const hk_surface_lists *l = s->lists;
  size_t count = 0;
  for (size_t k = 0; k < l->mesh.points; k++) s->held[l->mesh.point[k]] = s->model->inverse_mass[l->mesh.point[k]] == 0;
  for (int pass = 0; pass < 2; pass++) {
    for (uint32_t k = 0; k < l->items; k++)
      if (is_held(s, &l->item[k]) == (pass == 1)) s->order[count++] = k;
    if (pass == 0) s->moving = count;
  }
  s->ordered = true;
}

/* ---- boxes ---- */

typedef struct task {
  hk_surface_search *search;
  const hk_surface_move *move;
} task;

static void sweep_particle(const task *t, uint32_t i) {
  const hk_surface_move *m = t->move;
  hk_box *box = &t->search->swept[i];
  double margin = m->bare ? 0 : t->search->lists->margin[i];
  for (int c = 0; c < 3; c++) {
    double a = m->x_from[3 * (size_t)i + c], b = m->x_to[3 * (size_t)i + c], low = a < b ? a : b, high = a < b ? b : a;
    box->low[c] = low - margin - slack * (fabs(low) + margin + m->reach);
    box->high[c] = high + margin + slack * (fabs(high) + margin + m->reach);
  }
}

static bool is_finite(const double *x, uint32_t i) {
  return isfinite(x[3 * (size_t)i]) && isfinite(x[3 * (size_t)i + 1]) && isfinite(x[3 * (size_t)i + 2]);
}

static void sweep_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  bool lost = false;
  for (size_t k = begin; k < end; k++) {
    uint32_t i = t->search->lists->mesh.point[k];
    lost |= !is_finite(t->move->x_from, i) || !is_finite(t->move->x_to, i);
    sweep_particle(t, i);
  }
  t->search->lost[chunk] = lost;
}

static void box_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const hk_surface_search *s = ((const task *)context)->search;
  (void)chunk;
  for (size_t k = begin; k < end; k++) {
    const uint32_t *v = s->lists->item[s->order[k]].vertex;
    hk_box two = hk_box_around(&s->swept[v[0]], &s->swept[v[1]]);
    s->box[k] = hk_box_around(&two, &s->swept[v[2]]);
  }
}

static hk_status fit(hk_surface_search *s, const hk_host *host, task *t) {
  size_t points = s->lists->mesh.points, items = s->lists->items;
  host->parallel_for(host, points, GRAIN, sweep_chunk, t);
  for (size_t k = 0; k < chunks_of(points); k++)
    if (s->lost[k]) return HK_NOT_FINITE;
  bool anew = !hk_surface_search_pins_kept(s) || s->tree.items != items;
  if (anew) order_items(s);
  host->parallel_for(host, items, GRAIN, box_chunk, t);
  if (!anew) {
    hk_bvh_refit(&s->tree, s->box);
    anew = hk_bvh_cost(&s->tree) > spread * s->tree.built_cost;
  }
  return anew ? hk_bvh_build(&s->tree, host, s->box, items) : HK_OK;
}

/* ---- rows ---- */

typedef struct row {
  hk_surface_search *search;
  size_t k, chunk;
} row;

static void visit(void *context, uint32_t j) {
  const row *r = context;
  if (j <= r->k) return;
  hk_item_pair *pair = hk_gather_add(&r->search->rows, r->chunk);
  if (pair) *pair = (hk_item_pair){(uint32_t)r->k, j};
}

static void sort_row(hk_item_pair *pair, size_t count) {
  for (size_t k = 1; k < count; k++) {
    hk_item_pair kept = pair[k];
    size_t to = k;
    for (; to > 0 && pair[to - 1].b > kept.b; to--) pair[to] = pair[to - 1];
    pair[to] = kept;
  }
}

static void row_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  hk_surface_search *s = t->search;
  hk_gathered *list = &s->rows.list[chunk];
  for (size_t k = begin; k < end; k++) {
    size_t first = list->count;
    row r = {s, k, chunk};
    hk_box with = s->box[k];
    for (int c = 0; c < 3; c++) with.low[c] -= t->move->reach, with.high[c] += t->move->reach;
    hk_bvh_overlaps(&s->tree, s->box, &with, visit, &r);
    if (list->count > list->room) continue; /* the chunk is run again */
    hk_item_pair *pair = (hk_item_pair *)(void *)list->record + first;
    sort_row(pair, list->count - first);
    for (size_t q = 0; q < list->count - first; q++) pair[q] = (hk_item_pair){s->order[k], s->order[pair[q].b]};
  }
}

hk_status hk_surface_search_rows(hk_surface_search *s, const hk_host *host, const hk_surface_move *move) {
  task t = {s, move};
  hk_status status = fit(s, host, &t);
  return status == HK_OK ? hk_gather_run(&s->rows, host, s->moving, ROWS, row_chunk, &t) : status;
}
