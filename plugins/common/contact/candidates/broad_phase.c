#include "plugins/common/contact/candidates/broad_phase.h"

#include "plugins/kit/vector3.h"

enum { GRAIN = 2048 };

/* Of the extent of a move: positions are subtracted, multiplied by an axis and summed up, at 2^-53 of it each. */
static const double rounding = 0x1p-46;
/* Searches visit nodes in proportion to the cost of the tree, and building takes as long as some ten searches. */
static const double spread = 1.5;

/* ---- memory ---- */

static size_t chunks_of(size_t n) { return (n + GRAIN - 1) / GRAIN; }

hk_status hk_broad_phase_open(hk_broad_phase *s, const hk_host *host, const hk_surface_lists *lists,
                              const hk_model *model) {
  hk_broad_phase_free(s, host);
  *s = (hk_broad_phase){.lists = lists, .model = model, .near.record_size = sizeof(uint32_t)};
  hk_status status = hk_surface_items_build(&s->items, host, &lists->mesh, model->n);
  if (status != HK_OK) return status;
  s->swept = host->allocate(host, model->n * sizeof *s->swept);
  s->box = host->allocate(host, s->items.count * sizeof *s->box);
  s->order = host->allocate(host, s->items.count * sizeof *s->order);
  s->place = host->allocate(host, s->items.count * sizeof *s->place);
  s->place_of = host->allocate(host, s->items.count * sizeof *s->place_of);
  s->held = host->allocate(host, model->n * sizeof *s->held);
  s->extent = host->allocate(host, chunks_of(lists->mesh.points) * sizeof *s->extent);
  if (s->swept && s->box && s->order && s->place && s->place_of && s->held && s->extent) return HK_OK;
  hk_broad_phase_free(s, host);
  return host->fail(host, HK_NO_MEMORY, "no memory for the boxes of %zu particles", model->n);
}

void hk_broad_phase_free(hk_broad_phase *s, const hk_host *host) {
  void *memory[] = {s->swept, s->box, s->order, s->place, s->place_of, s->held, s->extent};
  for (size_t k = 0; k < sizeof memory / sizeof *memory; k++) host->release(host, memory[k]);
  hk_surface_items_free(&s->items, host);
  hk_bvh_free(&s->tree, host);
  hk_gather_free(&s->near, host);
  *s = (hk_broad_phase){0};
}

/* ---- what can move ---- */

static bool is_held(const hk_broad_phase *s, const hk_surface_item *item) {
  bool held = true;
  for (int c = 0; c < 4; c++) held &= s->held[item->vertex[c]];
  return held;
}

bool hk_broad_phase_pins_kept(const hk_broad_phase *s) {
  const hk_surface_mesh *m = &s->lists->mesh;
  bool kept = s->ordered;
  for (size_t k = 0; k < m->points; k++) kept &= !hk_model_moves(s->model, m->point[k]) == s->held[m->point[k]];
  return kept;
}

static void order_items(hk_broad_phase *s) {
  const hk_surface_lists *l = s->lists;
  size_t count = 0;
  for (size_t k = 0; k < l->mesh.points; k++) s->held[l->mesh.point[k]] = !hk_model_moves(s->model, l->mesh.point[k]);
  for (int pass = 0; pass < 2; pass++) {
    for (uint32_t k = 0; k < s->items.count; k++)
      if (is_held(s, &s->items.item[k]) == (pass == 1)) s->order[count++] = k;
    if (pass == 0) s->moving = count;
  }
  for (size_t k = 0; k < count; k++) {
    const uint32_t *v = s->items.item[s->order[k]].vertex;
    s->place_of[s->order[k]] = (uint32_t)k;
    s->place[k] = (hk_item_place){{v[0], v[1], v[2], v[3]}, hk_feature_radius(&l->mesh, v, 4)};
  }
  s->ordered = true;
  s->number++;
}

/* ---- positions ---- */

static void move_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  hk_broad_phase *s = context;
  const uint32_t *point = s->lists->mesh.point;
  const double *from = s->move.x_from, *to = s->move.x_to, *origin = from + 3 * (size_t)point[0];
  double extent = 0, zero = 0;
  for (size_t k = begin; k < end; k++) {
    size_t i = point[k];
    for (size_t c = 0; c < 3; c++) {
      double a = from[3 * i + c] - origin[c], b = to[3 * i + c] - origin[c];
      s->swept[i].x[c] = (hk_two){a, b};
      extent = fmax(extent, fmax(fabs(a), fabs(b)));
      zero += 0 * a + 0 * b; /* NAN where one is not finite */
    }
  }
  s->extent[chunk] = extent + zero;
}

hk_status hk_broad_phase_move(hk_broad_phase *s, const hk_host *host, const hk_surface_move *move) {
  size_t points = s->lists->mesh.points;
  double extent = 0;
  s->move = *move;
  if (!hk_broad_phase_pins_kept(s)) order_items(s);
  host->parallel_for(host, points, GRAIN, move_chunk, s);
  for (size_t k = 0; k < chunks_of(points); k++) {
    if (isnan(s->extent[k])) return HK_NOT_FINITE;
    extent = fmax(extent, s->extent[k]);
  }
  s->slack = rounding * (extent + (s->move.bare ? 0 : s->move.reach));
  return HK_OK;
}

/* The reach and the slack are added where it is asked for. */
void hk_broad_phase_box(hk_broad_phase *s, uint32_t k) {
  hk_swept_set set = hk_swept(s->swept, s->place[k].vertex, 4);
  double radius = s->move.bare ? 0 : s->place[k].radius;
  for (int c = 0; c < 3; c++) {
    hk_two_range r = hk_range_of(&set, c);
    s->box[k].low[c] = hk_lesser(r.low) - radius;
    s->box[k].high[c] = -hk_lesser(-r.high) + radius;
  }
}

static void box_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  (void)chunk;
  for (size_t k = begin; k < end; k++) hk_broad_phase_box(context, (uint32_t)k);
}

static hk_status fit(hk_broad_phase *s, const hk_host *host) {
  size_t items = s->items.count;
  bool anew = s->tree_number != s->number || s->tree.items != items;
  host->parallel_for(host, items, GRAIN, box_chunk, s);
  if (!anew) {
    hk_bvh_refit(&s->tree, host, s->box);
    anew = hk_bvh_cost(&s->tree) > spread * s->tree.built_cost;
  }
  hk_status status = anew ? hk_bvh_build(&s->tree, host, s->box, items) : HK_OK;
  if (status == HK_OK) s->tree_number = s->number;
  return status;
}

/* ---- rows ---- */

size_t hk_broad_phase_leaves(const hk_broad_phase *s) { return (s->tree.items + 3) / 4; }

size_t hk_broad_phase_leaf(const hk_broad_phase *s, size_t leaf, const uint32_t **place) {
  size_t rest = s->tree.items - 4 * leaf;
  *place = s->tree.order + 4 * leaf;
  return rest < 4 ? rest : 4;
}

static bool share(const uint32_t *a, const uint32_t *b) {
  bool found = false;
  for (int k = 0; k < 4; k++) found |= a[k] == b[0] || a[k] == b[1] || a[k] == b[2] || a[k] == b[3];
  return found;
}

hk_item_query hk_item_query_of(const hk_broad_phase *s, uint32_t k) {
  const uint32_t *v = s->place[k].vertex;
  hk_item_query i = {.place = k, .vertex = v, .set = hk_swept(s->swept, v, 4)};
  i.distance = hk_broad_phase_distance(s, s->place[k].radius);
  hk_normal_of(i.set.point[0], i.set.point[3], i.set.point[1], i.set.point[2], i.normal); /* of the diagonals */
  i.normal2 = hk_dot(i.normal, i.normal);
  i.along = hk_range_along(&i.set, i.normal);
  return i;
}

bool hk_item_query_misses(const hk_broad_phase *s, const hk_item_query *i, uint32_t other) {
  const uint32_t *v = s->place[other].vertex;
  if (share(i->vertex, v)) return false;
  hk_swept_set b = hk_swept(s->swept, v, 4);
  double distance = i->distance + (s->move.bare ? 0 : s->place[other].radius);
  double gap = hk_range_gap(i->along, hk_range_along(&b, i->normal));
  if (gap > 0 && gap * gap > distance * distance * i->normal2) return true;
  return hk_apart_by_middles(&i->set, &b, distance);
}

static void sort(uint32_t *list, size_t count) {
  for (size_t k = 1; k < count; k++) {
    uint32_t kept = list[k];
    size_t to = k;
    for (; to > 0 && list[to - 1] > kept; to--) list[to] = list[to - 1];
    list[to] = kept;
  }
}

/* A leaf's search for other leaves. Where they are more than can be kept it is made again for each item. */
typedef struct leaf_walk {
  hk_broad_phase *search;
  size_t chunk;
  hk_bvh_query with;
  hk_bvh_walk walk;
  size_t count;
  uint32_t found[HK_BVH_MOST];
  bool whole;
} leaf_walk;

static void begin_walk(leaf_walk *w) {
  hk_bvh_walk_begin(&w->walk, &w->search->tree, &w->with, false);
  w->count = hk_bvh_walk_on(&w->walk, w->found);
}

static void try_leaves(const leaf_walk *w, const hk_item_query *i, const hk_bvh_query *with) {
  hk_broad_phase *s = w->search;
  for (size_t q = 0; q < w->count; q++) {
    const uint32_t *place = s->tree.order + 4 * (size_t)w->found[q];
    for (unsigned hits = hk_bvh_hits(&s->tree.node[w->found[q]], with); hits; hits &= hits - 1) {
      uint32_t other = place[__builtin_ctz(hits)];
      if (other <= i->place || hk_item_query_misses(s, i, other)) continue;
      uint32_t *record = hk_gather_add(&s->near, w->chunk);
      if (record) *record = other;
    }
  }
}

/* The slack twice, so that rounding in the tree is never stricter than the comparison of features. */
static hk_bvh_query ask_around(const hk_broad_phase *s, const hk_box *box) {
  hk_box wide = *box;
  double distance = hk_broad_phase_distance(s, 0) + s->slack;
  for (int c = 0; c < 3; c++) wide.low[c] -= distance, wide.high[c] += distance;
  return hk_bvh_ask(&s->tree, &wide);
}

static void find_row(leaf_walk *w, uint32_t k) {
  hk_broad_phase *s = w->search;
  hk_bvh_query with = ask_around(s, &s->box[k]);
  hk_item_query i = hk_item_query_of(s, k);
  hk_gather_row(&s->near, w->chunk, k);
  if (!w->whole) begin_walk(w);
  do try_leaves(w, &i, &with);
  while (!w->whole && (w->count = hk_bvh_walk_on(&w->walk, w->found)) > 0);
  uint32_t *record = hk_gather_records(&s->near, k);
  if (record) sort(record, s->near.row[k].count);
}

static void search_leaf(leaf_walk *w, size_t leaf) {
  hk_broad_phase *s = w->search;
  const uint32_t *place;
  size_t count = hk_broad_phase_leaf(s, leaf, &place);
  hk_box around = s->box[place[0]];
  bool moves = false;
  for (size_t q = 0; q < count; q++) {
    moves |= place[q] < s->moving;
    for (int c = 0; c < 3; c++) {
      around.low[c] = fmin(around.low[c], s->box[place[q]].low[c]);
      around.high[c] = fmax(around.high[c], s->box[place[q]].high[c]);
    }
  }
  if (!moves) return;
  w->with = ask_around(s, &around);
  begin_walk(w);
  w->whole = w->walk.top == 0;
  for (size_t q = 0; q < count; q++)
    if (place[q] < s->moving) find_row(w, place[q]);
}

static void search_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  leaf_walk w = {.search = context, .chunk = chunk};
  for (size_t leaf = begin; leaf < end; leaf++) search_leaf(&w, leaf);
}

hk_status hk_broad_phase_run(hk_broad_phase *s, const hk_host *host, const hk_surface_move *move) {
  hk_status status = hk_broad_phase_move(s, host, move);
  if (status == HK_OK) status = fit(s, host);
  if (status != HK_OK) return status;
  return hk_gather_run(&s->near, host, s->moving, hk_broad_phase_leaves(s), HK_BROAD_PHASE_LEAVES, search_chunk, s);
}
