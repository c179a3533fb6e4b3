/* The stiffness of a hinge follows from the bending rigidity B of the surface, so that refinement changes nothing. The
 * energy is E = sum over hinges of 1/2 k C^2, with C the angle, or, for small angles, the jump of slope, and
 *     1/k = 1/2 (1/k_1 + 1/k_2),  k_t = B (sum of the squares of the sides)/(6 area) = 2/3 B (cot a + cot b + cot c)
 * of the two triangles, by their angles at rest. A plate has 1/2 B [(tr h)^2 - 2 (1 - nu) det h] per area, h the matrix
 * of second derivatives of its deflection. Hinges on regular meshes can be that for nu = -1/3, and with these numbers
 * are, exactly, on two of them.
 *
 * Equilateral triangles: k = 2/sqrt(3) B (Seung and Nelson, Phys. Rev. A 38 (1988), who have bending rigidity sqrt(3)/2
 * k and Gaussian rigidity -4/3 of that).
 *
 * Squares of alternating diagonals: all k = 4/3 B. Corners at which four triangles meet are free to move by
 * z = q a^2/4, those of eight by -q a^2/4, a the side. Angles across sides are then a (h_xx - q), a (h_yy - q), those
 * across diagonals sqrt(2) a (q +- h_xy): per area 1/2 B 4/3 [(h_xx - q)^2 + (h_yy - q)^2 + 2 h_xy^2 + 2 q^2], least
 * for q = tr h/4. With k = B |e|^2/(A1 + A2), e the edge and A1, A2 the areas, which is the same on equilateral
 * triangles, these squares would resist by 5/6 B across sides and 4/3 B across diagonals. Cells a tenth longer than
 * wide resist by 14 % more along their length.
 *
 * Others: squares of one diagonal each are no plate, 1/2 B 4/3 [(h_xx + h_xy)^2 + (h_yy + h_xy)^2 + 2 h_xy^2] with
 * diagonals along x = y, so they resist by 2/3 B to 10/3 B. Irregular meshes come near B the more even they are.
 *
 * nu acts at free borders only, since the integral of det h is one along the border: a narrow free strip resists by
 * (1 - nu^2) B = 8/9 B, a wide one by B.
 *
 * In Grinspun and others 2003 and Bergou and others 2006 the energy has the weight 3 |e|^2/(A1 + A2) (times 1/2 in the
 * latter). Each hinge then has the right mean curvature, but the sum of squares is three times that of a cylinder: one
 * in three edges bends, by three times the mean. */
#include "plugins/common/shells/bending.h"

#include "plugins/common/shells/hinge_list.h"

#include <string.h>

static const double FLAT = 1e-12; /* height over length of the edge below which a triangle has no area: hinge.c */

static hk_status reserve(hk_bending *b, const hk_host *host) {
  size_t n = b->count + 1;
  hk_elements *a = &b->element.acting;
  b->stiffness = host->allocate(host, n * sizeof *b->stiffness);
  b->damping = host->allocate(host, n * sizeof *b->damping);
  b->per_rigidity = host->allocate(host, n * sizeof *b->per_rigidity);
  b->shape = host->allocate(host, n * sizeof *b->shape);
  b->number = host->allocate(host, n * sizeof *b->number);
  a->node = (hk_tuples){0, 4, host->allocate(host, n * sizeof *b->id)};
  a->stiffness.value = host->allocate(host, n * sizeof(double));
  a->damping.value = host->allocate(host, n * sizeof(double));
  if (b->stiffness && b->damping && b->per_rigidity && b->shape && b->number && a->node.index && a->stiffness.value &&
      a->damping.value)
    return HK_OK;
  return host->fail(host, HK_NO_MEMORY, "no memory for %zu hinges", b->count);
}

/* The hinges by their indices, in b->id. */
static hk_status find(hk_bending *b, const hk_view *view, const hk_bending_params *given) {
  const hk_host *host = view->host;
  hk_hinge_list list = {0};
  bool triangles = given->triangles.count > 0, by_hand = given->hinges.count > 0;
  if (triangles && by_hand)
    return host->fail(host, HK_BAD_PARAM, "triangles and hinges are two ways to say the same: give one");
  hk_status status = by_hand ? hk_hinge_list_copy(&list, view, &given->hinges)
                             : hk_hinge_list_find(&list, view, triangles ? &given->triangles : &view->model->triangles);
  b->count = list.count;
  b->id = list.member;
  if (status == HK_OK && b->count == 0)
    return host->fail(host, HK_BAD_PARAM,
                      "there is nothing to bend: no two triangles share an edge%s; scene:grid and scene:mesh make some",
                      view->is_active ? " among `only` or `group`" : "");
  return status;
}

/* k/B of triangle t alone. */
static double stiffness_of(const hk_hinge_shape *s, int t) {
  double height = 2 * s->area[t] / s->length, before = s->foot[t] * s->length, behind = s->length - before;
  double sides = s->length * s->length + 2 * height * height + before * before + behind * behind;
  return sides / (6 * s->area[t]);
}

/* The numbers of hinge k, whose members are still indices; false: a triangle has no area. */
static bool measure(hk_bending *b, const hk_view *view, const hk_bending_params *given, size_t k) {
  hk_hinge_shape s = b->shape[k] = hk_hinge_shape_of(view->x, b->id[k]);
  double least = fmin(s.area[0], s.area[1]), factor = 2 / (1 / stiffness_of(&s, 0) + 1 / stiffness_of(&s, 1));
  b->per_rigidity[k] = factor;
  b->stiffness[k] = hk_tuple_value(&given->rigidity, k) * factor;
  b->damping[k] = given->damping.count ? hk_tuple_value(&given->damping, k) * factor : 0;
  return least > FLAT * s.length * s.length / 2;
}

static hk_status no_area(const hk_bending *b, const hk_view *view, size_t k) {
  uint32_t id[4];
  for (int m = 0; m < 4; m++) id[m] = view->model->id[b->id[k][m]];
  return view->host->fail(view->host, HK_BAD_PARAM,
                          "the hinge of particles {%u, %u, %u, %u} (edge, opposite corners): a triangle of it has no "
                          "area at the start, so there is no angle to bend",
                          id[0], id[1], id[2], id[3]);
}

hk_status hk_bending_create(hk_bending *b, const hk_view *view, const hk_bending_params *given) {
  hk_status status = find(b, view, given);
  if (status == HK_OK) status = reserve(b, view->host);
  b->triangles = view->model->triangles.count;
  if (status == HK_OK && !given->triangles.count && !given->hinges.count) {
    b->torn = view->host->allocate(view->host, b->count * sizeof *b->torn);
    if (!b->torn) status = view->host->fail(view->host, HK_NO_MEMORY, "no memory for %zu hinges", b->count);
  }
  for (size_t k = 0; k < b->count && status == HK_OK; k++)
    if (!measure(b, view, given, k)) status = no_area(b, view, k);
  for (size_t k = 0; k < b->count && status == HK_OK; k++)
    for (int m = 0; m < 4; m++) b->id[k][m] = view->model->id[b->id[k][m]];
  return status == HK_OK ? hk_bending_topology(b, view) : status;
}

/* The members of hinge k as indices; false: one of them is dead or does not act. */
static bool place(const hk_bending *b, const hk_view *view, size_t k, uint32_t member[4]) {
  bool alive = true;
  for (size_t m = 0; m < 4; m++) {
    size_t i = hk_model_find(view->model, b->id[k][m]);
    alive = alive && i < view->n && (!view->is_active || view->is_active[i]);
    member[m] = (uint32_t)i;
  }
  return alive;
}

/* Those that the scene's triangles have no more. The others are in the order of the start. */
static hk_status mark_torn(hk_bending *b, const hk_view *view) {
  hk_hinge_list list = {0};
  uint32_t member[4];
  size_t next = 0;
  if (!b->torn || view->model->triangles.count == b->triangles) return HK_OK;
  b->triangles = view->model->triangles.count;
  hk_status status = hk_hinge_list_find(&list, view, &view->model->triangles);
  for (size_t k = 0; k < b->count && status == HK_OK; k++) {
    bool there =
        place(b, view, k, member) && next < list.count && memcmp(member, list.member[next], sizeof member) == 0;
    b->torn[k] = !there;
    next += there;
  }
  view->host->release(view->host, list.member);
  return status;
}

hk_status hk_bending_topology(void *self, const hk_view *view) {
  hk_bending *b = self;
  hk_elements *a = &b->element.acting;
  uint32_t *index = (uint32_t *)(uintptr_t)a->node.index;
  size_t kept = 0;
  hk_status status = mark_torn(b, view);
  if (status != HK_OK) return status;
  for (size_t k = 0; k < b->count; k++) {
    bool alive = place(b, view, k, index + 4 * kept) && !(b->torn && b->torn[k]);
    if (!alive) continue;
    b->number[kept] = (uint32_t)k;
    a->stiffness.value[kept] = b->stiffness[k];
    a->damping.value[kept++] = b->damping[k];
  }
  a->node.count = a->stiffness.count = a->damping.count = kept;
  status = hk_part_sums_sort(&b->sums, view, &a->node, NULL);
  return status == HK_OK ? hk_chunk_rounds_sort(&b->rounds, view->host, view->n, &a->node) : status;
}
