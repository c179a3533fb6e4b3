/* Scenes: growing arrays of the particles, pins and plugins that the script describes. Every builder checks its
 * arguments before it writes, so a refused call does not change the scene. */
#include "core/scene/scene/scene.h"
#include "core/engine/base/base.h"
#include "core/engine/text/text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static hk_status no_memory(hk_error *error, const char *what) {
  return hk_error_set(error, HK_NO_MEMORY, "no memory for %s", what);
}

static char *scene_name(const char *script) {
  const char *slash = strrchr(script, '/');
  char *name = hk_string_copy(slash ? slash + 1 : script);
  size_t length = name ? strlen(name) : 0;
  if (length > 4 && strcmp(name + length - 4, ".lua") == 0) name[length - 4] = 0;
  return name;
}

hk_scene *hk_scene_create(const char *script, hk_registry *registry) {
  hk_scene *scene = calloc(1, sizeof *scene);
  if (!scene) return NULL;
  scene->name = scene_name(script);
  scene->script = hk_string_copy(script);
  scene->registry = registry;
  scene->duration = 1;
  scene->fps = 60;
  scene->dt = NAN;
  scene->tol = NAN;
  scene->accuracy = NAN;
  scene->warnings.silent = true; /* a run says them */
  uint32_t group;
  if (!scene->name || !scene->script || hk_scene_add_group(scene, "default", &group, NULL) != HK_OK) {
    hk_scene_destroy(scene);
    return NULL;
  }
  return scene;
}

static void destroy_specs(hk_specs *list) {
  for (size_t k = 0; k < list->count; k++) hk_spec_destroy(list->item[k]);
  free(list->item);
}

void hk_scene_spend(hk_scene *scene) {
  void *arrays[] = {scene->particles.position, scene->particles.velocity, scene->particles.mass,
                    scene->particles.group,    scene->particles.edge,     scene->particles.triangle};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
  for (size_t k = 0; k < scene->particles.channels; k++) {
    free(scene->particles.channel[k].value);
    scene->particles.channel[k].value = NULL;
  }
  scene->particles.position = scene->particles.velocity = scene->particles.mass = NULL;
  scene->particles.group = NULL;
  scene->particles.edge = NULL;
  scene->particles.triangle = NULL;
  scene->spent = scene->frozen = true;
}

static void destroy_lists(hk_scene *scene) {
  for (size_t k = 0; k < scene->particles.groups; k++) free(scene->particles.group_name[k]);
  for (size_t k = 0; k < scene->particles.channels; k++) {
    free(scene->particles.channel[k].name);
    free(scene->particles.channel[k].initial);
  }
  for (size_t k = 0; k < scene->particles.pins; k++) {
    free(scene->particles.pin[k].id);
    free(scene->particles.pin[k].where);
  }
  for (size_t k = 0; k < scene->measures; k++) {
    free(scene->measure[k].name);
    free(scene->measure[k].unit);
    free(scene->measure[k].where);
  }
  for (size_t k = 0; k < scene->controls; k++) {
    free(scene->control[k].name);
    free(scene->control[k].value);
  }
  for (size_t k = 0; k < scene->goals; k++) free(scene->goal[k].where);
}

static void free_bodies(hk_scene *scene) {
  for (size_t k = 0; k < scene->particles.skins; k++) {
    free((void *)(uintptr_t)scene->particles.skin[k].vertex);
    free((void *)(uintptr_t)scene->particles.skin[k].triangle);
  }
  free(scene->particles.skin);
  free(scene->particles.rider);
  free((void *)(uintptr_t)scene->distances.tuples.index);
  free((void *)(uintptr_t)scene->differences.tuples.index);
  free((void *)(uintptr_t)scene->ways.tuples.index);
}

void hk_scene_destroy(hk_scene *scene) {
  if (!scene) return;
  hk_scene_spend(scene);
  destroy_lists(scene);
  free_bodies(scene);
  for (int kind = 0; kind < HK_KINDS; kind++) destroy_specs(&scene->plugin[kind]);
  free(scene->particles.group_name);
  free(scene->strands.item);
  free(scene->particles.channel);
  free(scene->particles.pin);
  free(scene->measure);
  free(scene->control);
  free(scene->goal);
  for (size_t k = 0; k < scene->places.count; k++) free(scene->places.item[k].where);
  free(scene->places.item);
  hk_warnings_clear(&scene->warnings);
  free(scene->exact_where);
  free(scene->start_where);
  free(scene->auto_where);
  free(scene->start_file);
  free(scene->origin);
  free(scene->name);
  free(scene->script);
  free(scene);
}

static hk_status check_vectors(const char *what, const double *list, size_t count, hk_error *error) {
  for (size_t k = 0; list && k < 3 * count; k++)
    if (!isfinite(list[k]))
      return hk_error_set(error, HK_BAD_PARAM, "%s[%zu]: component %c is %g, not a finite number", what, k / 3 + 1,
                          "xyz"[k % 3], list[k]);
  return HK_OK;
}

static hk_status check_masses(const double *mass, size_t count, hk_error *error) {
  for (size_t i = 0; i < count; i++) {
    if (!isfinite(mass[i])) return hk_error_set(error, HK_BAD_PARAM, "mass: %g kg is not a finite number", mass[i]);
    if (mass[i] < 0) return hk_error_set(error, HK_BAD_PARAM, "mass: %g kg is below the minimum 0", mass[i]);
  }
  return HK_OK;
}

static hk_status resize(void *array, size_t count, size_t size) {
  void *memory; /* `array` is the address of a pointer of any type: read and written by memcpy, since pointer types do
                   not alias */
  memcpy(&memory, array, sizeof memory);
  void *bigger = realloc(memory, count * size);
  if (!bigger) return HK_NO_MEMORY;
  memcpy(array, &bigger, sizeof bigger);
  return HK_OK;
}

static hk_status reserve_particles(hk_scene *scene, size_t wanted) {
  if (wanted <= scene->capacity) return HK_OK;
  size_t grown = wanted > 2 * scene->capacity ? wanted : 2 * scene->capacity;
  if (resize(&scene->particles.position, grown, 3 * sizeof(double)) != HK_OK ||
      resize(&scene->particles.velocity, grown, 3 * sizeof(double)) != HK_OK ||
      resize(&scene->particles.mass, grown, sizeof(double)) != HK_OK ||
      resize(&scene->particles.group, grown, sizeof(uint32_t)) != HK_OK)
    return HK_NO_MEMORY;
  for (size_t k = 0; k < scene->particles.channels; k++)
    if (resize(&scene->particles.channel[k].value, grown, scene->particles.channel[k].size * sizeof(double)) != HK_OK)
      return HK_NO_MEMORY;
  scene->capacity = grown;
  return HK_OK;
}

static void fill_channels(hk_channel_spec *channel, size_t first, size_t count) {
  for (size_t i = first; i < first + count; i++)
    memcpy(channel->value + i * channel->size, channel->initial, channel->size * sizeof(double));
}

hk_status hk_scene_add_particles(hk_scene *scene, size_t count, const double *position, const double *velocity,
                                 const double *mass, double common_mass, uint32_t group, uint32_t *first_id,
                                 hk_error *error) {
  hk_status status = check_vectors("position", position, count, error);
  if (status == HK_OK) status = check_vectors("velocity", velocity, count, error);
  if (status == HK_OK) status = mass ? check_masses(mass, count, error) : check_masses(&common_mass, 1, error);
  if (status != HK_OK) return status;
  if (count > UINT32_MAX - 1 - scene->particles.n)
    return hk_error_set(error, HK_BAD_PARAM, "too many particles: at most %u", UINT32_MAX - 1);
  if (reserve_particles(scene, scene->particles.n + count) != HK_OK) return no_memory(error, "the particles");
  size_t first = scene->particles.n;
  if (count) memcpy(scene->particles.position + 3 * first, position, 3 * count * sizeof(double));
  for (size_t k = 0; k < 3 * count; k++) scene->particles.velocity[3 * first + k] = velocity ? velocity[k] : 0;
  for (size_t i = 0; i < count; i++) {
    scene->particles.mass[first + i] = mass ? mass[i] : common_mass;
    scene->particles.group[first + i] = group;
  }
  for (size_t k = 0; k < scene->particles.channels; k++) fill_channels(&scene->particles.channel[k], first, count);
  scene->particles.n += count;
  *first_id = (uint32_t)first + 1;
  return HK_OK;
}

hk_status hk_scene_add_group(hk_scene *scene, const char *name, uint32_t *group, hk_error *error) {
  for (size_t k = 0; k < scene->particles.groups; k++)
    if (strcmp(scene->particles.group_name[k], name) == 0) {
      *group = (uint32_t)k;
      return HK_OK;
    }
  char *copy = hk_string_copy(name);
  if (!copy || resize(&scene->particles.group_name, scene->particles.groups + 1, sizeof(char *)) != HK_OK) {
    free(copy);
    return no_memory(error, "the group");
  }
  *group = (uint32_t)scene->particles.groups;
  scene->particles.group_name[scene->particles.groups++] = copy;
  return HK_OK;
}

static hk_channel_spec *find_channel(const hk_scene *scene, const char *name) {
  for (size_t k = 0; k < scene->particles.channels; k++)
    if (strcmp(scene->particles.channel[k].name, name) == 0) return &scene->particles.channel[k];
  return NULL;
}

hk_status hk_scene_add_channel(hk_scene *scene, const char *name, size_t size, const double *initial, double decay,
                               const hk_function *rate, hk_error *error) {
  if (find_channel(scene, name)) return hk_error_set(error, HK_BAD_PARAM, "there is already a channel '%s'", name);
  if (*name == 0 || strpbrk(name, ",\"\r\n"))
    return hk_error_set(error, HK_BAD_PARAM,
                        "channel '%s': the name goes into the heads of tables: one without comma, quote and line break",
                        name);
  if (size < 1) return hk_error_set(error, HK_BAD_PARAM, "channel '%s': size must be at least 1", name);
  for (size_t k = 0; initial && k < size; k++)
    if (!isfinite(initial[k]))
      return hk_error_set(error, HK_BAD_PARAM, "channel '%s': initial: %g is not finite", name, initial[k]);
  hk_channel_spec channel = {.size = size, .decay = decay, .accuracy = NAN};
  if (rate) channel.rate = *rate;
  channel.name = hk_string_copy(name);
  channel.initial = calloc(size, sizeof(double));
  channel.value = malloc((scene->capacity * size + 1) * sizeof(double));
  if (!channel.name || !channel.initial || !channel.value ||
      resize(&scene->particles.channel, scene->particles.channels + 1, sizeof channel) != HK_OK) {
    free(channel.name);
    free(channel.initial);
    free(channel.value);
    return no_memory(error, "the channel");
  }
  if (initial) memcpy(channel.initial, initial, size * sizeof(double));
  fill_channels(&channel, 0, scene->particles.n);
  scene->particles.channel[scene->particles.channels++] = channel;
  return HK_OK;
}

static const char *channel_name(const void *context, size_t k) {
  const hk_scene *scene = context;
  return k < scene->particles.channels ? scene->particles.channel[k].name : NULL;
}

static hk_status check_id(const hk_scene *scene, uint32_t id, const char *what, hk_error *error) {
  if (id >= 1 && id <= scene->particles.n) return HK_OK;
  char known[64];
  return hk_error_set(error, HK_BAD_PARAM, "%s: there is no particle %u (%s)", what, id,
                      hk_known_ids(known, scene->particles.n));
}

hk_status hk_scene_set_channel(hk_scene *scene, const char *name, uint32_t id, const double *value, size_t count,
                               hk_error *error) {
  hk_channel_spec *channel = find_channel(scene, name);
  if (!channel) {
    const char *near = hk_nearest_name(name, channel_name, scene);
    return hk_error_set(error, HK_BAD_PARAM, "there is no channel '%s'%s%s%s", name, near ? "; did you mean '" : "",
                        near ? near : "", near ? "'?" : "");
  }
  hk_status status = check_id(scene, id, name, error);
  if (status != HK_OK) return status;
  if (count != channel->size)
    return hk_error_set(error, HK_BAD_PARAM, "channel '%s' takes %zu numbers, got %zu", name, channel->size, count);
  for (size_t k = 0; k < count; k++)
    if (!isfinite(value[k])) return hk_error_set(error, HK_BAD_PARAM, "channel '%s': %g is not finite", name, value[k]);
  memcpy(channel->value + (id - 1) * channel->size, value, count * sizeof(double));
  return HK_OK;
}

static void find_center(const hk_scene *scene, hk_pin_spec *pin) {
  for (int c = 0; c < 3; c++) {
    double sum = 0;
    for (size_t k = 0; k < pin->count; k++) sum += scene->particles.position[3 * (size_t)(pin->id[k] - 1) + (size_t)c];
    pin->center[c] = sum / fmax(1, (double)pin->count);
  }
}

hk_status hk_scene_add_pin(hk_scene *scene, const hk_pin_spec *spec, hk_error *error) {
  for (size_t k = 0; k < spec->count; k++) {
    hk_status status = check_id(scene, spec->id[k], "pin", error);
    if (status != HK_OK) return status;
  }
  hk_pin_spec pin = *spec;
  double length = sqrt(pin.axis[0] * pin.axis[0] + pin.axis[1] * pin.axis[1] + pin.axis[2] * pin.axis[2]);
  if (pin.kind == HK_PIN_LINE || pin.kind == HK_PIN_PLANE) {
    if (!isfinite(length) || length == 0)
      return hk_error_set(error, HK_BAD_PARAM, "pin: the direction must not be zero");
    for (int c = 0; c < 3; c++) pin.axis[c] /= length;
  }
  if (!(pin.release >= 0))
    return hk_error_set(error, HK_BAD_PARAM,
                        "pin: release: %g s is no time of the run: give one from 0 on, or leave it out", pin.release);
  if (isnan(pin.center[0])) find_center(scene, &pin);
  pin.where = hk_string_copy(spec->where ? spec->where : "");
  pin.id = malloc((spec->count + 1) * sizeof *pin.id);
  if (!pin.where || !pin.id || resize(&scene->particles.pin, scene->particles.pins + 1, sizeof pin) != HK_OK) {
    free(pin.where);
    free(pin.id);
    return no_memory(error, "the pin");
  }
  if (spec->count) memcpy(pin.id, spec->id, spec->count * sizeof *pin.id);
  scene->particles.pin[scene->particles.pins++] = pin;
  return HK_OK;
}

hk_status hk_scene_add_edges(hk_scene *scene, size_t count, const uint32_t (*edge)[2], hk_error *error) {
  for (size_t k = 0; k < 2 * count; k++) {
    hk_status status = check_id(scene, edge[k / 2][k % 2], "edge", error);
    if (status != HK_OK) return status;
  }
  if (count == 0) return HK_OK;
  if (resize(&scene->particles.edge, scene->particles.edges + count, sizeof *edge) != HK_OK)
    return no_memory(error, "the edges");
  memcpy(scene->particles.edge + scene->particles.edges, edge, count * sizeof *edge);
  scene->particles.edges += count;
  return HK_OK;
}

hk_status hk_scene_add_strand(hk_scene *scene, uint32_t first_id, size_t count, const double half_axis[2],
                              hk_error *error) {
  hk_strands *all = &scene->strands;
  if (resize(&all->item, all->count + 1, sizeof *all->item) != HK_OK) return no_memory(error, "the strand");
  all->item[all->count++] = (hk_strand){first_id, (uint32_t)count, sqrt(half_axis[0] * half_axis[1])};
  return HK_OK;
}

hk_status hk_scene_add_triangles(hk_scene *scene, size_t count, const uint32_t (*triangle)[3], hk_error *error) {
  for (size_t k = 0; k < 3 * count; k++) {
    hk_status status = check_id(scene, triangle[k / 3][k % 3], "triangle", error);
    if (status != HK_OK) return status;
  }
  if (count == 0) return HK_OK;
  if (resize(&scene->particles.triangle, scene->particles.triangles + count, sizeof *triangle) != HK_OK)
    return no_memory(error, "the triangles");
  memcpy(scene->particles.triangle + scene->particles.triangles, triangle, count * sizeof *triangle);
  scene->particles.triangles += count;
  return HK_OK;
}
