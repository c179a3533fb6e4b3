#include "plugins/common/contact/untangling/untangler.h"
#include "plugins/common/space/reserve.h"
#include "plugins/kit/vector3.h"

/* Successive rounds that may have more intersections than the best round; after that the state of the best one is
 * restored. The count rises for some rounds when an intersection curve crosses a vertex, and falls again. */
enum { PATIENCE = 30 };

hk_status hk_untangler_analyse(hk_untangler *u, const hk_model *model, const double *x) {
  hk_surface_intersections found;
  const hk_surface_mesh *mesh = u->surfaces->mesh(u->surfaces->self);
  hk_status status = u->surfaces->intersections(u->surfaces->self, x, &found);
  u->intersections = found.count;
  if (status == HK_OK) status = hk_contours_trace(&u->contours, u->host, mesh, &found);
  if (status != HK_OK || found.count == 0) return status;
  status = hk_contours_prolong(&u->prolong, &u->contours, u->host, mesh);
  if (status != HK_OK) return status;
  return hk_regions_fill(&u->regions, u->host, mesh, &u->contours, model->n, x);
}

static hk_status find_moves(hk_untangler *u, const hk_model *model, const double *x, const double *v) {
  hk_tangle tangle = {.mesh = u->surfaces->mesh(u->surfaces->self),
                      .contours = &u->contours,
                      .regions = &u->regions,
                      .model = model,
                      .x = x,
                      .v = v,
                      .beyond = u->clearance};
  return hk_displacements_find(&u->moves, u->host, &tangle);
}

/* Removes the relative velocities against the first pulls. */
static void stop(hk_untangler *u, const hk_model *model, hk_correction *c) {
  if (c->filter) c->filter(c, u->moves.kick);
  for (size_t k = 0; k < 3 * model->n; k++) {
    c->changed |= u->moves.kick[k] != 0;
    c->v[k] += u->moves.kick[k];
  }
}

static hk_status try_rounds(hk_untangler *u, const hk_model *model, hk_correction *c) {
  size_t least = u->intersections;
  int worse = 0;
  hk_status status = HK_OK;
  for (int64_t round = 0; round < u->rounds && least > 0 && worse < PATIENCE; round++) {
    status = find_moves(u, model, u->trial, round == 0 ? c->v : NULL);
    if (status != HK_OK) return status;
    if (round == 0) stop(u, model, c);
    if (c->filter) c->filter(c, u->moves.move);
    for (size_t k = 0; k < 3 * model->n; k++) u->trial[k] += u->moves.move[k];
    status = hk_untangler_analyse(u, model, u->trial);
    if (status != HK_OK) return status;
    worse = u->intersections <= least ? 0 : worse + 1;
    if (worse) continue;
    least = u->intersections;
    memcpy(c->x, u->trial, 3 * model->n * sizeof *c->x);
    c->changed = true;
  }
  return worse ? hk_untangler_analyse(u, model, c->x) : HK_OK;
}

static void account(hk_untangler *u, size_t n, const double *from, const double *to) {
  u->moved = 0;
  u->furthest = 0;
  for (size_t i = 0; i < n; i++) {
    double way[3];
    hk_subtract(way, to + 3 * i, from + 3 * i);
    u->moved += hk_length(way) > 0;
    u->furthest = fmax(u->furthest, hk_length(way));
  }
}

hk_status hk_untangler_free(hk_untangler *u, const hk_model *model, hk_correction *c) {
  hk_status status = hk_untangler_analyse(u, model, c->x);
  u->found = u->intersections;
  if (status != HK_OK || u->intersections == 0) return status;
  memcpy(u->seen, u->contours.kinds, sizeof u->seen);
  status = hk_reserve(u->host, &u->trial, &u->trial_room, 3 * model->n, sizeof *u->trial);
  if (status == HK_OK) status = hk_reserve(u->host, &u->from, &u->from_room, 3 * model->n, sizeof *u->from);
  if (status != HK_OK) return status;
  memcpy(u->trial, c->x, 3 * model->n * sizeof *c->x);
  memcpy(u->from, c->x, 3 * model->n * sizeof *c->x);
  status = try_rounds(u, model, c);
  account(u, model->n, u->from, c->x);
  return status;
}

void hk_untangler_mark(const hk_untangler *u, size_t n, double *mark) {
  const hk_surface_mesh *mesh = u->surfaces->mesh(u->surfaces->self);
  memset(mark, 0, n * sizeof *mark);
  if (u->intersections == 0) return;
  for (size_t k = 0; k < u->contours.points; k++) {
    const hk_contour_point *p = &u->contours.point[k];
    for (int j = 0; j < 2; j++) mark[mesh->edge[p->edge][j]] = 1;
    for (int j = 0; j < 3; j++) mark[mesh->triangle[p->triangle][j]] = 1;
  }
  for (size_t k = 0; k < u->regions.vertices; k++) mark[u->regions.vertex[k]] = 1;
}

void hk_untangler_close(hk_untangler *u) {
  hk_contours_free(&u->contours, u->host);
  hk_prolong_free(&u->prolong, u->host);
  hk_regions_free(&u->regions, u->host);
  hk_displacements_free(&u->moves, u->host);
  u->host->release(u->host, u->trial);
  u->host->release(u->host, u->from);
}
