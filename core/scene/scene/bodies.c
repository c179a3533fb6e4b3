/* What rigid bodies have beside particles: distances that do not change, riders, and surfaces for pictures.
 *
 * The distances of all bodies are one list, which the constraint's parameter points to: it grows with the scene. */
#include "core/engine/base/base.h"
#include "core/engine/contract/contract.h"
#include "core/scene/scene/scene.h"

#include <stdlib.h>
#include <string.h>

static hk_status no_memory(hk_error *error) { return hk_error_set(error, HK_NO_MEMORY, "no memory for the bodies"); }

/* Room for `count` items in the array at `array`, whose capacity is the next power of two of what it holds. */
static bool grow(void *array, size_t held, size_t count, size_t size) {
  void *memory;
  size_t room = 4, wanted = 4;
  memcpy(&memory, array, sizeof memory);
  while (room < held) room *= 2;
  while (wanted < count) wanted *= 2;
  if (memory && wanted <= room) return true;
  void *bigger = realloc(memory, wanted * size);
  if (bigger) memcpy(array, &bigger, sizeof bigger);
  return bigger != NULL;
}

/* ---- distances and joints ---- */

static bool keeps(const hk_plugin *plugin, const void *flag) {
  return plugin->constraint->flags & *(const unsigned *)flag && hk_param_list(plugin, NULL) != NULL;
}

static hk_status add_spec(hk_scene *scene, hk_kept_tuples *kept, unsigned flag, const char *label, const char *where,
                          hk_error *error) {
  const hk_plugin *plugin;
  hk_status status = hk_registry_prefer(scene->registry, HK_CONSTRAINT, keeps, &flag, &plugin, error);
  if (status == HK_OK)
    status = hk_scene_add_plugin(scene, HK_CONSTRAINT, plugin->name, label, where, &kept->spec, error);
  if (status == HK_OK) kept->spec->given[hk_param_list(plugin, NULL) - plugin->params] = true;
  return status;
}

static hk_status add_tuples(hk_kept_tuples *kept, unsigned arity, size_t count, const uint32_t *id, hk_error *error) {
  hk_tuples *list = &kept->tuples;
  uint32_t *index = (uint32_t *)(uintptr_t)list->index;
  if (!grow(&index, list->count, list->count + count, arity * sizeof *index)) return no_memory(error);
  for (size_t k = 0; k < arity * count; k++) index[arity * list->count + k] = id[k] - 1;
  *list = (hk_tuples){list->count + count, arity, index};
  *(hk_tuples *)hk_param_in(hk_param_list(kept->spec->plugin, NULL), kept->spec->values) = *list;
  return HK_OK;
}

hk_status hk_scene_add_distances(hk_scene *scene, const char *where, size_t count, const uint32_t (*pair)[2],
                                 hk_error *error) {
  hk_kept_tuples *kept = &scene->distances;
  hk_status status = kept->spec ? HK_OK : add_spec(scene, kept, HK_DISTANCES, "bodies", where, error);
  return status == HK_OK ? add_tuples(kept, 2, count, *pair, error) : status;
}

hk_status hk_scene_add_differences(hk_scene *scene, const char *where, size_t count, const uint32_t (*pair)[2],
                                   hk_error *error) {
  hk_kept_tuples *kept = &scene->differences;
  hk_status status = kept->spec ? HK_OK : add_spec(scene, kept, HK_DIFFERENCES, "joints", where, error);
  return status == HK_OK ? add_tuples(kept, 2, count, *pair, error) : status;
}

hk_status hk_scene_add_ways(hk_scene *scene, const char *where, size_t count, const uint32_t (*points)[4],
                            hk_error *error) {
  hk_kept_tuples *kept = &scene->ways;
  hk_status status = kept->spec ? HK_OK : add_spec(scene, kept, HK_WAYS, "sliders", where, error);
  return status == HK_OK ? add_tuples(kept, 4, count, *points, error) : status;
}

/* ---- riders ---- */

static bool is_rider(const hk_scene *scene, uint32_t id) {
  size_t low = 0, high = scene->particles.riders;
  while (low < high) {
    size_t middle = (low + high) / 2;
    if (scene->particles.rider[middle].particle < id)
      low = middle + 1;
    else
      high = middle;
  }
  return low < scene->particles.riders && scene->particles.rider[low].particle == id;
}

static hk_status check_rider(const hk_scene *scene, const hk_rider *r, hk_error *error) {
  const hk_particles *p = &scene->particles;
  double sum = 0;
  bool known = r->particle >= 1 && r->particle <= p->n && r->carriers >= 1 && r->carriers <= HK_CARRIERS;
  for (uint32_t k = 0; known && k < r->carriers; k++) {
    sum += r->weight[k];
    known = r->carrier[k] >= 1 && r->carrier[k] <= p->n;
  }
  if (!known) return hk_error_set(error, HK_BAD_PARAM, "rider %u: no such particle, or carrier", r->particle);
  if (!(fabs(sum - 1) <= 1e-9))
    return hk_error_set(error, HK_BAD_PARAM, "rider %u: the weights have the sum %.12g, and not 1", r->particle, sum);
  if (p->mass[r->particle - 1] != 0)
    return hk_error_set(error, HK_BAD_PARAM, "rider %u: it has a mass of %g kg; a rider has none", r->particle,
                        p->mass[r->particle - 1]);
  for (uint32_t k = 0; k < r->carriers; k++)
    if (is_rider(scene, r->carrier[k]) || r->carrier[k] == r->particle)
      return hk_error_set(error, HK_BAD_PARAM, "rider %u: particle %u is a rider itself, and cannot carry others",
                          r->particle, r->carrier[k]);
  if (p->riders && p->rider[p->riders - 1].particle >= r->particle)
    return hk_error_set(error, HK_BAD_PARAM, "rider %u: riders are made in the order of their ids", r->particle);
  return HK_OK;
}

hk_status hk_scene_add_rider(hk_scene *scene, const hk_rider *r, hk_error *error) {
  hk_particles *p = &scene->particles;
  hk_status status = check_rider(scene, r, error);
  if (status != HK_OK) return status;
  if (!grow(&p->rider, p->riders, p->riders + 1, sizeof *p->rider)) return no_memory(error);
  p->rider[p->riders++] = *r;
  double *x = p->position + 3 * (size_t)(r->particle - 1), *v = p->velocity + 3 * (size_t)(r->particle - 1);
  for (size_t c = 0; c < 3; c++) {
    x[c] = v[c] = 0;
    for (uint32_t k = 0; k < r->carriers; k++) {
      x[c] += r->weight[k] * p->position[3 * (size_t)(r->carrier[k] - 1) + c];
      v[c] += r->weight[k] * p->velocity[3 * (size_t)(r->carrier[k] - 1) + c];
    }
  }
  return HK_OK;
}

void hk_scene_mark_joint(hk_scene *scene, size_t before, bool meets) {
  hk_particles *p = &scene->particles;
  hk_rider *first = NULL;
  for (size_t k = p->riders; k-- > 0 && p->rider[k].particle > before;) first = &p->rider[k], first->meets = meets;
  if (first && !meets) first->joined = (uint32_t)before + 1, first->joints = (uint8_t)(p->n - before);
}

/* ---- surfaces ---- */

hk_status hk_scene_add_skin(hk_scene *scene, const hk_body_skin *skin, hk_error *error) {
  hk_particles *p = &scene->particles;
  size_t numbers = 3 * skin->vertices * sizeof(double), corners = skin->triangles * sizeof *skin->triangle;
  double *vertex = malloc(numbers + 1);
  uint32_t(*triangle)[3] = malloc(corners + 1);
  if (!vertex || !triangle || !grow(&p->skin, p->skins, p->skins + 1, sizeof *p->skin)) {
    free(vertex);
    free(triangle);
    return no_memory(error);
  }
  if (numbers) memcpy(vertex, skin->vertex, numbers);
  if (corners) memcpy(triangle, skin->triangle, corners);
  hk_body_skin *copy = &p->skin[p->skins++];
  *copy = *skin;
  copy->vertex = vertex;
  copy->triangle = (const uint32_t(*)[3])triangle;
  return HK_OK;
}
