#include "plugins/common/stress/stress.h"

#include "core/plugin/strain.h"
#include "plugins/common/solids/matrix3.h"
#include "plugins/kit/vector3.h"

const char *const hk_stress_names[HK_STRESS_KINDS] = {"tension", "sheet_stress", "solid_stress"};
const char *const hk_stress_units[HK_STRESS_KINDS] = {"N", "N/m", "Pa"};

/* Elements on quadruples are of a solid where their force has strains on quadruples: hinges, which are of four
 * particles too, have none. What damps alone has no stiffness. */
static bool is_solid(const hk_model *m, const hk_element_list *list) {
  for (size_t k = 0; k < m->element_lists; k++) {
    const hk_element_list *other = m->element_list + k;
    if (other->index == list->index && other->elements.node.arity == 4 && hk_elements_strained(&other->elements))
      return list->elements.node.arity == 4;
  }
  return false;
}

static bool is_of(const hk_model *m, const hk_element_list *list, hk_stress_kind kind) {
  const hk_elements *e = &list->elements;
  if (!list->acts || e->node.count == 0) return false;
  if (kind == HK_TENSION) return hk_elements_are_edges(e);
  if (kind == HK_SHEET_STRESS) return e->node.arity == 3 && hk_elements_strained(e);
  return is_solid(m, list);
}

bool hk_stress_any(const hk_model *m, hk_stress_kind kind) {
  for (size_t k = 0; k < m->element_lists; k++)
    if (is_of(m, m->element_list + k, kind)) return true;
  for (size_t k = 0; k < m->join_lists && kind == HK_TENSION; k++)
    if (m->join[k]->count) return true;
  return false;
}

typedef struct marked {
  const hk_model *model;
  const uint32_t *place;
  double *value;
} marked;

static void note(const marked *to, const uint32_t *member, unsigned arity, double stress) {
  for (unsigned m = 0; m < arity; m++) {
    uint32_t j = to->place ? to->place[member[m]] : member[m];
    if (j != UINT32_MAX && fabs(stress) > fabs(to->value[j])) to->value[j] = stress;
  }
}

/* Bars that hold a rigid body together are no part of the scene. */
static void note_bar(void *context, uint32_t i, uint32_t j, double force) {
  const marked *to = context;
  const bool *inside = to->model->inside;
  if (!(inside && inside[i] && inside[j])) note(to, (const uint32_t[]){i, j}, 2, force);
}

static double spring_force(const hk_elements *e, const double *x, size_t k) {
  const uint32_t *pair = hk_tuple(&e->node, k);
  double d[3];
  hk_subtract(d, x + 3 * (size_t)pair[1], x + 3 * (size_t)pair[0]);
  return hk_tuple_value(&e->stiffness, k) * (hk_length(d) - hk_tuple_value(&e->rest, k));
}

/* Six times the volume of a tetrahedron with these sides, or twice the area of a triangle. */
static double extent(double side[3][3], unsigned sides) {
  double normal[3];
  hk_cross(normal, side[0], side[1]);
  return sides == 3 ? fabs(hk_dot(normal, side[2])) / 6 : hk_length(normal) / 2;
}

/* Moments are about the first member: the forces of an element have no sum. */
static double principal_stress(const hk_elements *e, const double *x, size_t k) {
  double C[HK_ELEMENT_VALUES] = {0}, dC[4 * HK_ELEMENT_VALUES][3], side[3][3], S[9] = {0}, value[3], Q[9], largest = 0;
  const uint32_t *node = hk_tuple(&e->node, k);
  unsigned sides = e->node.arity - 1;
  for (unsigned m = 0; m < sides; m++) hk_subtract(side[m], x + 3 * (size_t)node[m + 1], x + 3 * (size_t)node[0]);
  e->evaluate(e->self, x, k, k + 1, C, dC);
  for (unsigned q = 0; q < e->values; q++)
    for (unsigned m = 0; m < sides; m++)
      for (int c = 0; c < 9; c++) S[c] += C[q] * dC[(sides + 1) * q + m + 1][c / 3] * side[m][c % 3];
  double scale = hk_tuple_value(&e->stiffness, k) / extent(side, sides);
  for (int c = 0; c < 9; c++) S[c] *= scale;
  for (int c = 0; c < 9; c++)
    if (!isfinite(S[c])) return 0; /* an element of no extent has no stress */
  hk_matrix3_eigen(S, value, Q);
  for (int c = 0; c < 3; c++)
    if (fabs(value[c]) > fabs(largest)) largest = value[c];
  return largest;
}

hk_status hk_particle_stresses(const hk_view *view, const hk_frame *frame, hk_stress_kind kind, const uint32_t *place,
                               size_t count, double *value) {
  const hk_model *m = view->model;
  marked to = {m, place, value};
  for (size_t j = 0; j < count; j++) value[j] = 0;
  for (size_t l = 0; l < m->element_lists; l++) {
    const hk_elements *e = &m->element_list[l].elements;
    if (!is_of(m, m->element_list + l, kind) || e->stiffness.count == 0) continue;
    for (size_t k = 0; k < e->node.count; k++) {
      double stress = hk_elements_are_edges(e) ? spring_force(e, view->x, k) : principal_stress(e, view->x, k);
      note(&to, hk_tuple(&e->node, k), e->node.arity, stress);
    }
  }
  if (kind != HK_TENSION || !frame->bar_forces) return HK_OK;
  return frame->bar_forces(frame, &(hk_pair_forces){&to, note_bar});
}
