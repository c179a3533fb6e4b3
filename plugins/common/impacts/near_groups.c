/* Groups are found by sorting pairs by the patch of their first feature, by counting, and those of one such patch by
 * when the other was seen first. */
#include "plugins/common/impacts/near_groups.h"

#include <string.h>

static void homes_of(const hk_nearby *s, size_t k, uint32_t *a, uint32_t *b) {
  const hk_surface_pair *pair = &s->pair[k];
  int first = pair->kind == HK_POINT_TRIANGLE ? 1 : 2;
  *a = hk_patch_of(&s->patches, pair->vertex, first);
  *b = hk_patch_of(&s->patches, pair->vertex + first, 4 - first);
}

static void sort_by_first(hk_nearby *s) {
  size_t *at = s->by_home;
  uint32_t a, b;
  memset(at, 0, (s->patches.count + 1) * sizeof *at);
  for (size_t k = 0; k < s->count; k++) {
    homes_of(s, k, &a, &b);
    at[a + 1]++;
  }
  for (size_t p = 0; p < s->patches.count; p++) at[p + 1] += at[p];
  for (size_t k = 0; k < s->count; k++) {
    homes_of(s, k, &a, &b);
    s->sorted[at[a]++] = (uint32_t)k;
  }
}

/* seen[b]: 1 + the last group with b as its second patch. */
static void number_groups(hk_nearby *s) {
  memset(s->seen, 0, s->patches.count * sizeof *s->seen);
  for (size_t e = 0; e < s->count; e++) {
    uint32_t k = s->sorted[e], a, b;
    homes_of(s, k, &a, &b);
    if (!s->seen[b] || s->group[s->seen[b] - 1].a != a) {
      s->group[s->groups] = (hk_near_group){.a = a, .b = b, .due = -INFINITY};
      s->seen[b] = (uint32_t)++s->groups;
    }
    s->group_of[k] = s->seen[b] - 1;
    s->group[s->group_of[k]].start++;
  }
}

void hk_near_groups_make(hk_nearby *s) {
  size_t sum = 0;
  s->groups = 0;
  sort_by_first(s);
  number_groups(s);
  for (size_t g = 0; g < s->groups; g++) sum = s->group[g].start += sum;
  s->group[s->groups].start = sum;
  for (size_t e = s->count; e-- > 0;) s->in_group[--s->group[s->group_of[s->sorted[e]]].start] = s->sorted[e];
  for (size_t k = 0; k < s->count; k++) s->due[k] = -INFINITY;
}

static void mark_group(hk_nearby *s, size_t g) {
  hk_near_group *group = &s->group[g];
  double least = INFINITY;
  for (size_t e = group->start; e < group[1].start; e++) {
    uint32_t k = s->in_group[e];
    if (!(s->due[k] > group->path_to)) s->marks[k / 64] |= (uint64_t)1 << k % 64;
    least = s->due[k] < least ? s->due[k] : least;
  }
  group->due = least;
}

void hk_near_groups_mark(hk_nearby *s) {
  size_t words = (s->count + 63) / 64;
  memset(s->marks, 0, words * sizeof *s->marks);
  for (size_t g = 0; g < s->groups; g++)
    if (!(s->group[g].due > s->group[g].path_to)) mark_group(s, g);
  s->dues = 0;
  for (size_t w = 0; w < words; w++)
    for (uint64_t left = s->marks[w]; left; left &= left - 1) {
      uint32_t k = (uint32_t)(64 * w) + (uint32_t)__builtin_ctzll(left);
      if (!s->surfaces->leaves(s->surfaces->self, &s->pair[k])) s->index[s->dues++] = k;
    }
}

/* ---- boxes ---- */

static void widen(hk_patch_box *box, const double *x, double radius) {
  for (int c = 0; c < 3; c++) {
    box->low[c] = fmin(box->low[c], x[c] - radius);
    box->high[c] = fmax(box->high[c], x[c] + radius);
  }
}

void hk_near_boxes_make(hk_nearby *s) {
  const double *radius = s->surfaces->mesh(s->surfaces->self)->radius;
  for (size_t k = 0; k < s->patches.count; k++) {
    hk_patch_box *box = &s->box[k];
    *box = (hk_patch_box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (size_t e = s->patches.start[k]; e < s->patches.start[k + 1]; e++) {
      size_t i = s->patches.member[e];
      widen(box, s->found->from + 3 * i, radius[i]);
      widen(box, s->found->to + 3 * i, radius[i]);
    }
  }
}

static double square_between(const hk_patch_box *a, const hk_patch_box *b) {
  double sum = 0;
  for (int c = 0; c < 3; c++) {
    double d = fmax(0, fmax(a->low[c] - b->high[c], b->low[c] - a->high[c]));
    sum += d * d;
  }
  return sum;
}

bool hk_near_boxes_apart(const hk_nearby *s, double skin) {
  double most = 0, zero = 0; /* NaN where a place is not finite */
  for (size_t k = 0; k < s->patches.count; k++) {
    const hk_patch_move *m = &s->moves[k];
    double way = sqrt(m->mean[0] * m->mean[0] + m->mean[1] * m->mean[1] + m->mean[2] * m->mean[2]) + m->spread;
    most = fmax(most, way);
    zero += 0 * way;
  }
  if (2 * most + zero < skin) return true;
  for (size_t a = 0; a < s->patches.count; a++)
    for (size_t b = 0; b <= a; b++) {
      double nearer = hk_patch_approach(&s->moves[a], &s->moves[b]);
      if (nearer < skin) continue;
      double most_apart = nearer + s->reach;
      if (!(square_between(&s->box[a], &s->box[b]) * (1 - 1e-9) > most_apart * most_apart)) return false;
    }
  return true;
}
