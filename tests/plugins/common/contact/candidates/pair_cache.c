/* Which pairs are looked at in a step, against a search of all: surfaces that turn, fold and shake past each other in
 * random steps, slow and fast, with two ends tried in some. What has to be found is every pair that hk_pair_motion lets
 * meet, and in the same order whenever the lists were begun. */
#include "plugins/common/contact/impulses/impact.h"
#include "plugins/common/contact/candidates/pair_cache.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { SIDE = 12, SHEETS = 3, MOST = 600, STEPS = 120 };
static const double cell = 0.02, skin = 2e-3;

typedef struct world {
  test_engine e;
  const hk_surfaces *surfaces;
  const hk_host *host;
  hk_view view;
  double x[3 * MOST], to[3 * MOST], *seen;
  uint64_t seed[4];
} world;

static double between(world *w, double low, double high) { return low + (high - low) * hk_random_uniform(w->seed); }

static void add_sheet(world *w, double z) {
  uint32_t triangle[2 * SIDE * SIDE][3], first = (uint32_t)w->e.scene->particles.n + 1;
  size_t count = 0;
  for (int k = 0; k < SIDE * SIDE; k++) test_particle(&w->e, cell * (k % SIDE), cell * (k / SIDE), z, 1);
  for (uint32_t k = 0; k < (SIDE - 1) * SIDE; k++) {
    if (k % SIDE == SIDE - 1) continue;
    uint32_t a = first + k;
    memcpy(triangle[count++], (uint32_t[]){a, a + 1, a + SIDE}, sizeof *triangle);
    memcpy(triangle[count++], (uint32_t[]){a + 1, a + SIDE + 1, a + SIDE}, sizeof *triangle);
  }
  assert_int_equal(hk_scene_add_triangles(w->e.scene, count, (const uint32_t(*)[3])triangle, &w->e.error), HK_OK);
}

static const hk_surfaces *table_of(test_engine *e) {
  const hk_instances *services = &e->run->plugins.kind[HK_SERVICE];
  for (size_t k = 0; k < services->count; k++)
    if (strcmp(services->item[k]->plugin->name, "surfaces") == 0)
      return services->item[k]->plugin->service->table(services->item[k]->self);
  fail_msg("the run has no surfaces");
  return NULL;
}

/* Three sheets, the lowest one pinned, a strand and some particles. */
static void open_world(world *w, uint64_t seed, int threads) {
  memset(w, 0, sizeof *w);
  hk_random_seed(w->seed, seed);
  test_engine_open(&w->e);
  w->e.scene->threads = threads;
  w->e.scene->fps = 10;
  w->e.options.dt = 0.01;
  for (int k = 0; k < SHEETS; k++) add_sheet(w, 0.01 * k);
  for (uint32_t id = 1; id <= SIDE * SIDE; id++) test_pin(&w->e, HK_PIN_FIXED, id, NULL);
  for (int k = 0; k < 30; k++) {
    uint32_t id = test_particle(&w->e, 0.008 * k, 0.1, 0.035, 1);
    const uint32_t edge[1][2] = {{id - 1, id}};
    if (k > 0 && k < 20) assert_int_equal(hk_scene_add_edges(w->e.scene, 1, edge, &w->e.error), HK_OK);
  }
  test_plugin(&w->e, HK_CORRECTOR, "contact");
  test_run(&w->e);
  w->surfaces = table_of(&w->e);
  w->host = &w->e.run->plugins.kind[HK_CORRECTOR].item[0]->host;
  w->view = *hk_run_view(w->e.run);
  assert_true(w->view.n <= MOST);
  memcpy(w->x, w->view.x, 3 * w->view.n * sizeof *w->x);
  w->view.x = w->x;
}

/* Sheets move and turn as wholes, and every particle shakes. */
static void move(world *w, double size) {
  double c[3], turn = between(w, -10, 10) * size, shake = size * between(w, 0, 0.5);
  for (size_t i = 0; i < w->view.n; i++) {
    if (i % (SIDE * SIDE) == 0)
      for (int k = 0; k < 3; k++) c[k] = between(w, -size, size);
    const double *x = w->x + 3 * i;
    bool held = w->view.model->inverse_mass[i] == 0;
    double step[3] = {c[0] - turn * (x[1] - 0.1), c[1] + turn * (x[0] - 0.1), c[2] + 3 * turn * (x[0] - 0.1)};
    for (int k = 0; k < 3; k++) w->to[3 * i + (size_t)k] = x[k] + (held ? 0 : step[k] + between(w, -shake, shake));
  }
}

/* ---- what has to be found ---- */

static double gap_at(const hk_feature_pair *pair, const hk_pair_path *path, double part) {
  double x[12];
  for (int k = 0; k < 12; k++) x[k] = path->from[k] + part * (path->to[k] - path->from[k]);
  return sqrt(hk_nearest_of_pair(pair->kind, x).squared) - pair->offset;
}

/* How far the vertex goes that goes farthest: a gap falls by twice that at most, as both its ends stay weighted means
 * of the vertices. */
static double farthest(const hk_pair_path *path) {
  double most = 0;
  for (int v = 0; v < 12; v += 3) {
    double d[3];
    for (int k = 0; k < 3; k++) d[k] = path->to[v + k] - path->from[v + k];
    most = fmax(most, d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  }
  return sqrt(most);
}

static bool has_to(const world *w, const hk_feature_pair *pair) {
  hk_pair_path path;
  hk_pair_path_of(&path, pair, w->x, w->to);
  double begin = gap_at(pair, &path, 0), most = 2 * farthest(&path) * (1 + 1e-9); /* beyond rounding of the squares */
  if (begin < fmin(skin, hk_pair_motion(pair->kind, &path))) return true;
  for (int k = 0; k <= 16 && begin <= most; k++)
    if (gap_at(pair, &path, k / 16.0) < 0) return true;
  return false;
}

static bool may_meet(const world *w, const hk_feature_pair *pair, double *gap) {
  hk_pair_path path;
  hk_pair_path_of(&path, pair, w->x, w->to);
  *gap = sqrt(hk_nearest_of_pair(pair->kind, path.from).squared) - pair->offset;
  return *gap <= hk_pair_motion(pair->kind, &path);
}

typedef struct key {
  uint64_t kind, low, high;
} key;

static key key_of(const hk_feature_pair *p) {
  uint64_t a = (uint64_t)p->vertex[0] << 32 | p->vertex[1], b = (uint64_t)p->vertex[2] << 32 | p->vertex[3];
  bool swap = p->kind == HK_EDGE_EDGE && b < a;
  return (key){p->kind, swap ? b : a, swap ? a : b};
}

static int rising(const void *a, const void *b) { return memcmp(a, b, sizeof(key)); }

typedef struct keys {
  size_t count;
  key *key;
} keys;

static keys all_that_have_to(world *w) {
  hk_feature_pairs found;
  assert_int_equal(w->surfaces->pairs(w->surfaces->self, w->x, w->to, skin, &found), HK_OK);
  keys all = {.key = malloc((found.count + 1) * sizeof *all.key)};
  for (size_t k = 0; k < found.count; k++)
    if (has_to(w, &found.pair[k])) all.key[all.count++] = key_of(&found.pair[k]);
  return all;
}

static keys those_of(const world *w, hk_pair_cache *near) {
  keys all = {.key = malloc((near->active + 1) * sizeof *all.key)};
  for (size_t d = 0; d < near->active; d++) {
    double gap;
    if (may_meet(w, &near->pair[near->index[d]], &gap)) all.key[all.count++] = key_of(&near->pair[near->index[d]]);
    if (gap > 0) hk_pair_cache_set_gap(near, near->index[d], gap);
  }
  return all;
}

static size_t compare(world *w, hk_pair_cache *early, hk_pair_cache *late) {
  keys must = all_that_have_to(w);
  hk_pair_cache *nearby[] = {early, late};
  keys found[2];
  for (int k = 0; k < 2; k++) {
    if (hk_pair_cache_find(nearby[k], w->x, w->to) != HK_OK) fail_msg("%s", w->e.run->error.text);
    found[k] = those_of(w, nearby[k]);
  }
  assert_int_equal(found[0].count, found[1].count);
  assert_memory_equal(found[0].key, found[1].key, found[0].count * sizeof(key));
  qsort(found[0].key, found[0].count, sizeof(key), rising);
  for (size_t k = 0; k < must.count; k++)
    assert_non_null(bsearch(&must.key[k], found[0].key, found[0].count, sizeof(key), rising));
  free(must.key), free(found[0].key), free(found[1].key);
  return must.count;
}

static void open_lists(world *w, hk_pair_cache *near) {
  if (hk_pair_cache_open(near, w->host, &w->view, w->surfaces, skin) != HK_OK) fail_msg("%s", w->e.run->error.text);
}

static size_t walk(uint64_t seed, int threads, double size) {
  world w;
  hk_pair_cache early = {0}, late = {0};
  size_t found = 0;
  open_world(&w, seed, threads);
  open_lists(&w, &early);
  for (int step = 0; step < STEPS; step++) {
    if (step % 7 == 0) open_lists(&w, &late); /* it has begun just now */
    hk_pair_cache_begin(&early, w.x);
    hk_pair_cache_begin(&late, w.x);
    int tries = step % 3 == 0 ? 2 : 1;
    for (int k = 0; k < tries; k++) {
      move(&w, step % 40 == 39 ? 50 * size : size);
      found += compare(&w, &early, &late);
    }
    hk_pair_cache_end(&early, w.to);
    hk_pair_cache_end(&late, w.to);
    memcpy(w.x, w.to, sizeof w.x);
  }
  test_engine_close(&w.e);
  return found;
}

static void every_pair_that_may_meet_is_found_in_one_order(void **state) {
  (void)state;
  size_t found = 0;
  for (uint64_t seed = 1; seed <= 3; seed++) found += walk(seed, 1, 5e-5) + walk(seed, 2, 5e-4) + walk(seed, 1, 3e-3);
  assert_true(found > 10000); /* or the test would show nothing */
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(every_pair_that_may_meet_is_found_in_one_order)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
