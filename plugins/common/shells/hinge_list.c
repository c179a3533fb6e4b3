/* Hinges are found by sorting the sides of all triangles by their ends: the sides of one edge then follow one another.
 * A side has its ends in rising order, so the orientation of triangles does not matter, and a hinge's angle has the
 * sign that its own edge gives it. */
#include "plugins/common/shells/hinge_list.h"

#include <stdlib.h>
#include <string.h>

typedef struct side {
  uint32_t a, b, opposite, triangle;
} side;

static int by_ends(const void *left, const void *right) {
  const side *s = left, *t = right;
  if (s->a != t->a) return s->a < t->a ? -1 : 1;
  if (s->b != t->b) return s->b < t->b ? -1 : 1;
  return (s->triangle > t->triangle) - (s->triangle < t->triangle);
}

static bool acts(const hk_view *view, const uint32_t *member, unsigned arity) {
  bool all = true;
  for (unsigned m = 0; m < arity && view->is_active; m++) all = all && view->is_active[member[m]];
  return all;
}

/* The sides of the triangles that act, sorted. */
static size_t collect(side *list, const hk_view *view, const hk_tuples *triangles) {
  size_t count = 0;
  for (size_t t = 0; t < triangles->count; t++) {
    const uint32_t *corner = hk_tuple(triangles, t);
    for (int k = 0; k < 3 && acts(view, corner, 3); k++) {
      uint32_t a = corner[k], b = corner[(k + 1) % 3];
      list[count++] = (side){a < b ? a : b, a < b ? b : a, corner[(k + 2) % 3], (uint32_t)t};
    }
  }
  qsort(list, count, sizeof *list, by_ends);
  return count;
}

static bool same_edge(const side *s, const side *t) { return s->a == t->a && s->b == t->b; }

/* The edge of the sides s[0] to s[count - 1], which more than two triangles have, or two that lie on one another. */
static hk_status not_manifold(const hk_view *view, const side *s, size_t count) {
  const uint32_t *id = view->model->id;
  if (count == 2)
    return view->host->fail(view->host, HK_BAD_PARAM,
                            "the triangles %u and %u have the same corners, the particles %u, %u and %u: remove one",
                            s[0].triangle + 1, s[1].triangle + 1, id[s->a], id[s->b], id[s->opposite]);
  return view->host->fail(
      view->host, HK_BAD_PARAM,
      "the edge from particle %u to particle %u belongs to %zu triangles, among them %u, %u and %u: a "
      "hinge has two; take the surface apart there, or list the hinges by hand (hinges = )",
      id[s->a], id[s->b], count, s[0].triangle + 1, s[1].triangle + 1, s[2].triangle + 1);
}

static hk_status pair_sides(hk_hinge_list *list, const hk_view *view, const side *s, size_t sides) {
  for (size_t k = 0, count; k < sides; k += count) {
    for (count = 1; k + count < sides && same_edge(&s[k], &s[k + count]); count++) continue;
    if (count > 2 || (count == 2 && s[k].opposite == s[k + 1].opposite)) return not_manifold(view, s + k, count);
    if (count < 2) continue;
    const uint32_t member[4] = {s[k].a, s[k].b, s[k].opposite, s[k + 1].opposite};
    memcpy(list->member[list->count++], member, sizeof member);
  }
  return HK_OK;
}

static hk_status reserve(hk_hinge_list *list, const hk_host *host, size_t count) {
  *list = (hk_hinge_list){.member = host->allocate(host, (count + 1) * sizeof *list->member)};
  return list->member ? HK_OK : host->fail(host, HK_NO_MEMORY, "no memory for %zu hinges", count);
}

hk_status hk_hinge_list_find(hk_hinge_list *list, const hk_view *view, const hk_tuples *triangles) {
  const hk_host *host = view->host;
  hk_status status = reserve(list, host, 3 * triangles->count / 2);
  if (status != HK_OK) return status;
  side *sides = host->allocate(host, (3 * triangles->count + 1) * sizeof *sides);
  if (!sides) return host->fail(host, HK_NO_MEMORY, "no memory for the sides of %zu triangles", triangles->count);
  status = pair_sides(list, view, sides, collect(sides, view, triangles));
  host->release(host, sides);
  return status;
}

hk_status hk_hinge_list_copy(hk_hinge_list *list, const hk_view *view, const hk_tuples *hinges) {
  hk_status status = reserve(list, view->host, hinges->count);
  for (size_t k = 0; k < hinges->count && status == HK_OK; k++)
    if (acts(view, hk_tuple(hinges, k), 4))
      memcpy(list->member[list->count++], hk_tuple(hinges, k), sizeof *list->member);
  return status;
}
