/* Collects the springs (plain edges) that forces offer as elements, in the scene's order, and the pins.
 *
 * Forces come and go by their `from` and `to`, pins are released: both are noticed by comparing with what was collected
 * last, which costs a look at the lists and one pass over inverse masses and pins. The projector of a sliding particle
 * is read off hk_system.filter, which is linear and acts on each particle alone: its columns are the filtered unit
 * vectors. Invariant: while `valid`, the arrays have room for all springs of the present topology, acting or not. */
#include "plugins/common/springs/element_edges.h"

#include <string.h>

static hk_status split(hk_system *s) {
  for (size_t k = 0; k < s->split->forces; k++) {
    const hk_force_info *force = &s->split->force[k];
    s->split->takes[k] = !force->elements;
    if (!force->elements && force->flags & HK_CONSERVES_MOMENTUM && force->flags & HK_DEPENDS_ON_X)
      return s->host->fail(s->host, HK_FAILED,
                           "force '%s' acts between particles and offers no elements, by which this method solves: use "
                           "springs for it, or an integrator that needs none, such as backward_euler or leapfrog",
                           force->label);
  }
  return HK_OK;
}

static bool same_lists(const hk_element_edges *e, const hk_model *model) {
  bool same = e->valid && e->lists == model->element_lists;
  for (size_t k = 0; same && k < e->lists; k++) same = e->acts[k] == model->element_list[k].acts;
  return same;
}

static bool same_pins(const hk_element_edges *e, const hk_model *model) {
  return e->valid && e->n == model->n && memcmp(e->pin, model->pin, e->n) == 0 &&
         memcmp(e->inverse_mass, model->inverse_mass, e->n * sizeof *e->inverse_mass) == 0;
}

static void *renew(const hk_host *host, void *old, size_t count, size_t size) {
  host->release(host, old);
  return host->allocate(host, (count + 1) * size);
}

static hk_status reserve(hk_element_edges *e, const hk_host *host, const hk_model *model) {
  size_t springs = 0, n = model->n;
  for (size_t k = 0; k < model->element_lists; k++)
    if (hk_elements_are_edges(&model->element_list[k].elements)) springs += model->element_list[k].elements.node.count;
  e->pair = renew(host, e->pair, springs, sizeof *e->pair);
  e->stiffness = renew(host, e->stiffness, springs, sizeof *e->stiffness);
  e->damping = renew(host, e->damping, springs, sizeof *e->damping);
  e->rest = renew(host, e->rest, springs, sizeof *e->rest);
  e->acts = renew(host, e->acts, model->element_lists, sizeof *e->acts);
  e->inverse_mass = renew(host, e->inverse_mass, n, sizeof *e->inverse_mass);
  e->pin = renew(host, e->pin, n, 1);
  e->slide = renew(host, e->slide, n, sizeof *e->slide);
  e->projector = renew(host, e->projector, n, sizeof *e->projector);
  e->capacity = springs;
  e->lists = model->element_lists;
  e->n = n;
  bool fine = e->pair && e->stiffness && e->damping && e->rest && e->acts && e->inverse_mass && e->pin && e->slide &&
              e->projector;
  return fine ? HK_OK
              : host->fail(host, HK_NO_MEMORY, "no memory for the lists of %zu springs and %zu particles", springs, n);
}

static void collect_springs(hk_element_edges *e, const hk_model *model) {
  e->count = 0;
  for (size_t k = 0; k < model->element_lists; k++) {
    const hk_elements *list = &model->element_list[k].elements;
    e->acts[k] = model->element_list[k].acts;
    if (!e->acts[k] || !hk_elements_are_edges(list)) continue;
    for (size_t q = 0; q < list->node.count; q++, e->count++) {
      memcpy(e->pair[e->count], hk_tuple(&list->node, q), sizeof e->pair[0]);
      e->stiffness[e->count] = hk_tuple_value(&list->stiffness, q);
      e->damping[e->count] = list->damping.count ? hk_tuple_value(&list->damping, q) : 0;
      e->rest[e->count] = list->rest.count ? hk_tuple_value(&list->rest, q) : 0;
    }
  }
}

static void read_projectors(hk_element_edges *e, hk_system *s, double *scratch) {
  for (size_t c = 0; c < 3 && e->slides > 0; c++) {
    for (size_t k = 0; k < 3 * e->n; k++) scratch[k] = k % 3 == c;
    s->filter(s, scratch);
    for (size_t i = 0; i < e->n; i++)
      for (size_t r = 0; e->slide[i] != HK_NO_SLIDE && r < 3; r++)
        e->projector[e->slide[i]][3 * r + c] = scratch[3 * i + r];
  }
}

static void collect_pins(hk_element_edges *e, hk_system *s, double *scratch) {
  memcpy(e->inverse_mass, s->model->inverse_mass, e->n * sizeof *e->inverse_mass);
  memcpy(e->pin, s->model->pin, e->n);
  e->slides = e->paths = 0;
  for (size_t i = 0; i < e->n; i++) {
    bool slides = e->pin[i] == HK_PIN_LINE || e->pin[i] == HK_PIN_PLANE;
    e->slide[i] = slides ? (uint32_t)e->slides++ : HK_NO_SLIDE;
    e->paths += e->pin[i] == HK_PIN_PATH;
  }
  read_projectors(e, s, scratch);
}

hk_status hk_element_edges_take(hk_element_edges *e, hk_system *s, double *scratch, bool *changed) {
  hk_status status = split(s);
  *changed = false;
  if (status != HK_OK) return status;
  bool springs = same_lists(e, s->model), pins = same_pins(e, s->model);
  if (springs && pins) return HK_OK;
  *changed = true;
  if (!e->valid) status = reserve(e, s->host, s->model);
  if (status != HK_OK) return status;
  collect_springs(e, s->model);
  collect_pins(e, s, scratch);
  e->valid = true;
  return HK_OK;
}

void hk_element_edges_drop(hk_element_edges *e) { e->valid = false; }

hk_status hk_element_edges_uncoupled(const hk_system *s) {
  for (size_t k = 0; k < s->model->element_lists; k++) {
    const hk_element_list *list = &s->model->element_list[k];
    if (list->elements.node.count > 0 && !hk_elements_are_edges(&list->elements))
      return s->host->fail(s->host, HK_FAILED,
                           "the elements of force '%s' are not plain edges, which is all that this method knows: take "
                           "xpbd, local_global or backward_euler for them",
                           list->force);
  }
  return HK_OK;
}
