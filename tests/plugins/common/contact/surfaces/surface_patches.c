/* Patches: every item is in one of them, with its particles; and what the search of all pairs of patches finds is what
 * the search of everything finds and is near, each once. */
#include "plugins/common/contact/surfaces/surface_patches.h"
#include "tests/support/surface_scenes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Two sheets, a pinned one, strands and isolated particles. */
static test_surfaces *random_surfaces(int threads, uint64_t seed) {
  test_surfaces *s = test_surfaces_open(threads, seed, 1500);
  test_surfaces_sheet(s, 14, (double[]){0, 0, 0});
  test_surfaces_sheet(s, 9, (double[]){0.1, 0.1, 0.03});
  uint32_t first = test_surfaces_sheet(s, 4, (double[]){-0.2, 0.3, -0.02});
  for (uint32_t k = 0; k < 25; k++) test_surfaces_hold(s, first + k);
  for (int k = 0; k < 5; k++)
    test_surfaces_strand(s, 60, (double[]){test_uniform(s, 0, 1), test_uniform(s, 0, 1), -0.2},
                         (double[]){0.01, 0, 0.01});
  for (int k = 0; k < 20; k++) test_surfaces_particle(s, test_uniform(s, 0, 1), test_uniform(s, 0, 1), 0);
  test_surfaces_list(s);
  return s;
}

static void open_patches(test_surfaces *s, hk_surface_patch_set *p) {
  if (hk_surface_patches_open(p, test_surfaces_host(s), &s->search) != HK_OK) fail_msg("%s", s->error.text);
}

static bool has(const hk_surface_patch_set *p, size_t patch, uint32_t particle) {
  for (size_t e = p->table.start[patch]; e < p->table.start[patch + 1]; e++)
    if (p->table.member[e] == particle) return true;
  return false;
}

static void patches_divide_the_items(void **state) {
  (void)state;
  test_surfaces *s = random_surfaces(1, 3);
  hk_surface_patch_set p = {0};
  size_t items = s->search.items.count, *seen = calloc(items, sizeof *seen);
  open_patches(s, &p);
  assert_int_equal(p.first[p.table.count], items);
  for (size_t k = 0; k < p.table.count; k++) {
    assert_true(p.first[k + 1] > p.first[k] && p.first[k + 1] - p.first[k] <= HK_PATCH_MOST);
    for (size_t e = p.first[k]; e < p.first[k + 1]; e++) {
      seen[p.item[e]]++;
      for (int c = 0; c < 4; c++) assert_true(has(&p, k, s->search.items.item[p.item[e]].vertex[c]));
    }
  }
  for (size_t k = 0; k < items; k++) assert_int_equal(seen[k], 1);
  /* isolated particles are alone; the rest is in patches of half the wanted size at least on average */
  assert_true(p.table.count - 20 < items / (HK_PATCH_ITEMS / 2));
  free(seen);
  hk_surface_patches_free(&p, test_surfaces_host(s));
  test_surfaces_close(s);
}

/* ---- pairs ---- */

typedef struct key {
  uint64_t kind, low, high;
} key;

static key key_of(const hk_feature_pair *p) {
  uint64_t a = (uint64_t)p->vertex[0] << 32 | p->vertex[1], b = (uint64_t)p->vertex[2] << 32 | p->vertex[3];
  bool swap = p->kind == HK_EDGE_EDGE && b < a;
  return (key){p->kind, swap ? b : a, swap ? a : b};
}

static int rising(const void *a, const void *b) { return memcmp(a, b, sizeof(key)); }

static double gap_at(const hk_feature_pair *pair, const hk_surface_move *move, double part) {
  double x[12];
  for (int k = 0; k < 12; k++) {
    size_t i = 3 * (size_t)pair->vertex[k / 3] + (size_t)k % 3;
    x[k] = (1 - part) * move->x_from[i] + part * move->x_to[i];
  }
  return sqrt(hk_nearest_of_pair(pair->kind, x).squared) - pair->offset;
}

static size_t search_patches(test_surfaces *s, const hk_surface_move *move, hk_gather *near) {
  hk_surface_patch_set p = {0};
  size_t count = 0;
  open_patches(s, &p);
  hk_patch_pair *pair = malloc(p.table.count * (p.table.count + 1) / 2 * sizeof *pair);
  for (uint32_t a = 0; a < p.table.count; a++)
    for (uint32_t b = a; b < p.table.count; b++) pair[count++] = (hk_patch_pair){a, b};
  const hk_host *host = test_surfaces_host(s);
  assert_int_equal(hk_patch_pairs_find(&s->search, &p, host, move, pair, count, near), HK_OK);
  assert_int_equal(hk_gather_join(near, host), HK_OK);
  free(pair);
  hk_surface_patches_free(&p, host);
  return near->count;
}

/* Rounding of gaps: 1e-12 of lengths of order 1. */
static size_t compare(test_surfaces *s, const hk_surface_move *move) {
  hk_gather near = {.record_size = sizeof(hk_feature_pair)};
  size_t count = search_patches(s, move, &near), must = 0;
  key *found = malloc((count + 1) * sizeof *found);
  const hk_feature_pair *pair = near.record;
  for (size_t k = 0; k < count; k++) {
    found[k] = key_of(&pair[k]);
    double gap = gap_at(&pair[k], move, 0);
    assert_true(pair[k].gap <= gap && pair[k].gap > gap - 1e-12);
  }
  qsort(found, count, sizeof *found, rising);
  for (size_t k = 1; k < count; k++) assert_true(rising(&found[k - 1], &found[k]) != 0);
  assert_int_equal(hk_feature_pairs_find(&s->search, test_surfaces_host(s), move, &s->pairs), HK_OK);
  assert_true(count <= s->pairs.count);
  for (size_t k = 0; k < s->pairs.count; k++) {
    const hk_feature_pair *one = (const hk_feature_pair *)s->pairs.record + k;
    double least = INFINITY;
    for (int part = 0; part <= 8; part++) least = fmin(least, gap_at(one, move, part / 8.0));
    if (!(least < move->reach)) continue;
    key wanted = key_of(one);
    assert_non_null(bsearch(&wanted, found, count, sizeof *found, rising));
    must++;
  }
  free(found);
  hk_gather_free(&near, test_surfaces_host(s));
  return must;
}

static void pairs_of_patches_are_those_of_the_whole(void **state) {
  (void)state;
  size_t must = 0;
  for (uint64_t seed = 1; seed <= 12; seed++) {
    test_surfaces *s = random_surfaces(1 + (int)(seed % 2), seed);
    size_t size = 3 * s->model.n;
    double *to = malloc(size * sizeof *to), shake = seed % 3 == 0 ? 0.1 : 0.01;
    for (size_t k = 0; k < size; k++) {
      s->x[k] += test_uniform(s, -0.01, 0.01);
      to[k] = s->x[k] + test_uniform(s, -shake, shake);
    }
    must += compare(s, &(hk_surface_move){.x_from = s->x, .x_to = to, .reach = seed % 4 == 0 ? 0 : 0.02});
    free(to);
    test_surfaces_close(s);
  }
  assert_true(must > 10000); /* or the test would show nothing */
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(patches_divide_the_items),
      cmocka_unit_test(pairs_of_patches_are_those_of_the_whole),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
