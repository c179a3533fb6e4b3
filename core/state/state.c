/* The state vector and the model: who is in the scene, where, and how births and deaths change that.
 *
 * X = (x, v, channels, work) in one allocation. Ids rise with the index: the dead close ranks in order and the born are
 * appended, so an id is found by bisection. */
#include "core/run/engine.h"
#include "core/base/memory.h"
#include "core/base/random.h"

#include <stdlib.h>
#include <string.h>

static hk_status no_memory(hk_run *run) {
  return hk_error_set(&run->error, HK_NO_MEMORY, "no memory for the state of %zu particles", run->model.n);
}

static size_t state_size(const hk_run *run, size_t n) { return (6 + run->width) * n + 1; }

static void set_inverse_mass(hk_run *run) {
  for (size_t i = 0; i < run->model.n; i++) {
    bool held = run->pin[i] == HK_PIN_FIXED || run->pin[i] == HK_PIN_PATH;
    run->inverse_mass[i] = held || run->mass[i] == 0 ? 0 : 1 / run->mass[i];
  }
}

void hk_state_view(hk_run *run) {
  size_t n = run->model.n;
  hk_system *s = &run->system;
  s->model = &run->model;
  s->X = run->X;
  s->n = n;
  s->size = state_size(run, n);
  run->view = (hk_view){.t = s->t, .n = n, .x = run->X, .v = run->X + 3 * n, .model = &run->model, .acting = n};
  run->view.y = run->width ? run->X + 6 * n : NULL;
  run->view.host = s->host;
  for (size_t k = 0; k < run->scene->force.count; k++) {
    const hk_instance *force = run->scene->force.item[k];
    hk_view *view = &run->force_view[k];
    *view = run->view;
    view->host = &force->host;
    view->active = force->active;
    view->is_active = force->is_active;
    if (force->is_active) view->acting = force->acting;
  }
}

static hk_status open_channels(hk_run *run) {
  hk_scene *scene = run->scene;
  run->channel = calloc(scene->channels + 1, sizeof *run->channel);
  if (!run->channel) return no_memory(run);
  for (size_t k = 0; k < scene->channels; k++) {
    run->channel[k] = (hk_channel){scene->channel[k].name, scene->channel[k].size, run->width};
    run->width += scene->channel[k].size;
  }
  run->model.channels = scene->channels;
  run->model.channel = run->channel;
  return HK_OK;
}

static hk_status allocate(hk_run *run, size_t n) {
  run->mass = malloc((n + 1) * sizeof *run->mass);
  run->inverse_mass = malloc((n + 1) * sizeof *run->inverse_mass);
  run->id = malloc((n + 1) * sizeof *run->id);
  run->group = malloc((n + 1) * sizeof *run->group);
  run->pin = calloc(n + 1, sizeof *run->pin);
  run->X = calloc(state_size(run, n), sizeof *run->X);
  run->edge = malloc((run->scene->edges + 1) * sizeof *run->edge);
  run->triangle = malloc((run->scene->triangles + 1) * sizeof *run->triangle);
  run->force_view = calloc(run->scene->force.count + 1, sizeof *run->force_view);
  run->force_acts = calloc(run->scene->force.count + 1, sizeof *run->force_acts);
  run->element_list = calloc(run->scene->force.count + 1, sizeof *run->element_list);
  bool fine =
      run->mass && run->inverse_mass && run->id && run->group && run->pin && run->X && run->edge && run->triangle;
  return fine && run->force_view && run->force_acts && run->element_list ? HK_OK : no_memory(run);
}

static void copy_particles(hk_run *run) {
  const hk_scene *scene = run->scene;
  size_t n = scene->n;
  memcpy(run->X, scene->position, 3 * n * sizeof(double));
  memcpy(run->X + 3 * n, scene->velocity, 3 * n * sizeof(double));
  for (size_t k = 0; k < scene->channels; k++)
    memcpy(run->X + (6 + run->channel[k].offset) * n, scene->channel[k].value,
           n * run->channel[k].size * sizeof(double));
  memcpy(run->mass, scene->mass, n * sizeof *run->mass);
  memcpy(run->group, scene->group, n * sizeof *run->group);
  for (size_t i = 0; i < n; i++) run->id[i] = (uint32_t)i + 1;
  for (size_t e = 0; e < 2 * scene->edges; e++) run->edge[e / 2][e % 2] = scene->edge[e / 2][e % 2] - 1;
  for (size_t e = 0; e < 3 * scene->triangles; e++) run->triangle[e / 3][e % 3] = scene->triangle[e / 3][e % 3] - 1;
}

void hk_state_publish(hk_run *run) {
  hk_model *m = &run->model;
  m->mass = run->mass;
  m->inverse_mass = run->inverse_mass;
  m->id = run->id;
  m->group = run->group;
  m->pin = run->pin;
  m->groups = run->scene->groups;
  m->group_name = (const char *const *)run->scene->group_name;
  m->edges.pair = (const uint32_t(*)[2])run->edge;
  m->triangle = (const uint32_t(*)[3])run->triangle;
  m->element_list = run->element_list;
}

hk_status hk_state_open(hk_run *run) {
  const hk_scene *scene = run->scene;
  if (scene->n == 0 && scene->source.count == 0)
    return hk_error_set(&run->error, HK_BAD_PARAM,
                        "the scene is empty: add particles (scene:particle, scene:grid, ...) or a source");
  hk_status status = open_channels(run);
  if (status == HK_OK) status = allocate(run, scene->n);
  if (status != HK_OK) return status;
  run->model.n = scene->n;
  run->model.edges.count = scene->edges;
  run->model.triangles = scene->triangles;
  run->next_id = (uint32_t)scene->n + 1;
  if (scene->n) copy_particles(run);
  hk_state_publish(run);
  status = hk_pins_open(run);
  if (status != HK_OK) return status;
  for (size_t i = 0; i < run->model.n; i++)
    if (run->mass[i] == 0 && (run->pin[i] == HK_FREE || run->pin[i] == HK_PIN_LINE || run->pin[i] == HK_PIN_PLANE))
      return hk_error_set(&run->error, HK_BAD_PARAM, "particle %u: mass 0 kg needs a pin; give it a mass or pin it",
                          run->id[i]);
  set_inverse_mass(run);
  hk_state_view(run);
  return HK_OK;
}

double hk_run_extent(const hk_run *run) {
  double extent = 0;
  for (int c = 0; c < 3; c++) {
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < run->model.n; i++) {
      low = fmin(low, run->X[3 * i + (size_t)c]);
      high = fmax(high, run->X[3 * i + (size_t)c]);
    }
    extent = fmax(extent, high - low);
  }
  return extent > 0 ? extent : 1;
}

void hk_state_perturb(hk_run *run) {
  uint64_t random[4];
  double size = run->options.perturb * hk_run_extent(run);
  hk_random_seed(random, run->options.perturb_seed);
  for (size_t i = 0; i < run->model.n; i++)
    for (int c = 0; c < 3; c++) {
      double off = size * (2 * hk_random_uniform(random) - 1);
      bool moves = run->pin[i] == HK_FREE || run->pin[i] == HK_PIN_LINE || run->pin[i] == HK_PIN_PLANE;
      if (moves) run->X[3 * i + (size_t)c] += off; /* what slides is put back on its line when pins are imposed */
    }
}

void hk_state_close(hk_run *run) {
  free(run->mass);
  free(run->inverse_mass);
  free(run->id);
  free(run->group);
  free(run->pin);
  free(run->X);
  free(run->edge);
  free(run->triangle);
  free(run->force_view);
  free(run->force_acts);
  free(run->element_list);
  free(run->channel);
}

void hk_elements_refresh(hk_run *run) {
  size_t lists = 0;
  for (size_t k = 0; k < run->scene->force.count; k++) {
    hk_instance *force = run->scene->force.item[k];
    if (!force->plugin->force->elements) continue;
    hk_element_list *list = &run->element_list[lists++];
    list->force = force->label;
    list->index = k;
    list->acts = run->force_acts[k];
    force->plugin->force->elements(force->self, &run->force_view[k], &list->elements);
  }
  run->model.element_lists = lists;
}

bool hk_run_index(const hk_run *run, uint32_t id, uint32_t *index) {
  size_t low = 0, high = run->model.n;
  while (low < high) {
    size_t middle = (low + high) / 2;
    if (run->id[middle] < id)
      low = middle + 1;
    else
      high = middle;
  }
  *index = (uint32_t)low;
  return low < run->model.n && run->id[low] == id;
}
