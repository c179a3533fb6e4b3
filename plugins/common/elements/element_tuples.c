/* Collects the tuples of all lists with an `evaluate`. Plain edges are collected by element_edges.c: every element of a
 * scene is in one of the two. The numbers C and gradients of a tuple have their own places in arrays over all tuples,
 * so that several threads can evaluate them and one thread then sums them in the order of the scene. */
#include "plugins/common/elements/element_tuples.h"

#include <string.h>

static hk_status reserve(hk_element_tuples *t, const hk_host *host, const hk_model *model) {
  t->capacity = t->most_values = t->most_gradients = 0;
  for (size_t l = 0; l < model->element_lists; l++) {
    const hk_elements *e = &model->element_list[l].elements;
    if (hk_elements_are_edges(e)) continue;
    t->capacity += e->node.count;
    t->most_values += e->node.count * e->values;
    t->most_gradients += e->node.count * e->values * e->node.arity;
  }
  host->release(host, t->item);
  host->release(host, t->list);
  t->item = host->allocate(host, (t->capacity + 1) * sizeof *t->item);
  t->list = host->allocate(host, (model->element_lists + 1) * sizeof *t->list);
  if (t->item && t->list) return HK_OK;
  return host->fail(host, HK_NO_MEMORY, "no memory for a list of %zu elements", t->capacity);
}

static void append(hk_element_tuples *t, const hk_elements *list) {
  for (size_t k = 0; k < list->node.count; k++) {
    hk_element_tuple *e = &t->item[t->count];
    *e = (hk_element_tuple){.list = list, .k = k, .first = t->values, .gradient = t->gradients};
    memcpy(e->member, hk_tuple(&list->node, k), list->node.arity * sizeof e->member[0]);
    e->stiffness = hk_tuple_value(&list->stiffness, k);
    e->damping = list->damping.count ? hk_tuple_value(&list->damping, k) : 0;
    if (e->stiffness == 0 && e->damping == 0) continue;
    t->count++;
    t->values += list->values;
    t->gradients += list->values * list->node.arity;
  }
}

hk_status hk_element_tuples_take(hk_element_tuples *t, const hk_host *host, const hk_model *model, bool fresh) {
  hk_status status = fresh ? reserve(t, host, model) : HK_OK;
  t->count = t->values = t->gradients = 0;
  if (status != HK_OK) return status;
  for (size_t l = 0; l < model->element_lists; l++) {
    t->list[l] = model->element_list[l].elements;
    if (model->element_list[l].acts && !hk_elements_are_edges(&t->list[l])) append(t, &t->list[l]);
  }
  return HK_OK;
}
