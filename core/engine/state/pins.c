/* Pins: restrictions of the motion of particles. Fixed and scripted particles have the inverse mass 0, so no force
 * moves them; for sliding particles the forbidden components of vectors are projected away. A scripted particle is put
 * on its path before every evaluation, at that evaluation's time, so that a method keeps its order with moving
 * boundaries. */
#include "core/engine/state/state.h"

#include <stdlib.h>
#include <string.h>

static hk_status open_pin(hk_pin_state *pin, hk_state *state, hk_error *error) {
  const hk_pin_spec *spec = pin->spec;
  pin->index = malloc((spec->count + 1) * sizeof *pin->index);
  pin->origin = malloc((spec->count + 1) * 3 * sizeof *pin->origin);
  if (!pin->index || !pin->origin) return hk_error_set(error, HK_NO_MEMORY, "no memory for the pins");
  for (size_t k = 0; k < spec->count; k++) {
    uint32_t i;
    if (!hk_state_index(state, spec->id[k], &i)) continue; /* the particle died before the checkpoint */
    if (state->pin[i] == HK_PIN_RIDES)
      return hk_error_set(error, HK_BAD_PARAM,
                          "%s: pin: particle %u is a point of a rigid body and goes where that goes: join it to a "
                          "pinned particle by a constraint, or the body to what stands still by a joint",
                          spec->where, spec->id[k]);
    if (state->pin[i] != HK_FREE)
      return hk_error_set(error, HK_BAD_PARAM, "%s: pin: particle %u is pinned already: leave it out of one of the two",
                          spec->where, spec->id[k]);
    if (state->mass[i] == 0 && isfinite(spec->release))
      return hk_error_set(error, HK_BAD_PARAM, "%s: pin: particle %u has no mass and cannot be released", spec->where,
                          spec->id[k]);
    state->pin[i] = (uint8_t)spec->kind;
    pin->index[pin->count] = i;
    memcpy(pin->origin + 3 * pin->count++, state->start->position + 3 * (spec->id[k] - 1), 3 * sizeof(double));
    if (spec->kind == HK_PIN_FIXED) memset(state->X + 3 * (state->model.n + i), 0, 3 * sizeof(double));
  }
  return HK_OK;
}

static int by_particle(const void *a, const void *b) {
  const hk_pin_place *p = a, *q = b;
  return (p->particle > q->particle) - (p->particle < q->particle);
}

/* What moves or slides, in the order of the particles. */
static void list_places(hk_pins *pins) {
  pins->places = 0;
  for (uint32_t k = 0; k < pins->count; k++)
    for (uint32_t j = 0; pins->item[k].spec->kind != HK_PIN_FIXED && j < pins->item[k].count; j++)
      pins->place[pins->places++] = (hk_pin_place){pins->item[k].index[j], k, j};
  qsort(pins->place, pins->places, sizeof *pins->place, by_particle);
}

hk_status hk_pins_open(hk_pins *pins, hk_state *state, hk_error *error) {
  pins->item = calloc(state->start->pins + 1, sizeof *pins->item);
  if (!pins->item) return hk_error_set(error, HK_NO_MEMORY, "no memory for the pins");
  while (pins->count < state->start->pins) {
    hk_pin_state *pin = &pins->item[pins->count];
    pin->spec = &state->start->pin[pins->count++];
    hk_status status = open_pin(pin, state, error);
    if (status != HK_OK) return status;
    pins->has_paths |= pin->spec->kind == HK_PIN_PATH;
    pins->has_slides |= pin->spec->kind == HK_PIN_LINE || pin->spec->kind == HK_PIN_PLANE;
  }
  hk_state_refresh(state); /* fixed and scripted particles get the inverse mass 0 */
  size_t room = 0;
  for (size_t k = 0; k < pins->count; k++) room += pins->item[k].count;
  pins->place = malloc((room + 1) * sizeof *pins->place);
  if (!pins->place) return hk_error_set(error, HK_NO_MEMORY, "no memory for the pins");
  list_places(pins);
  return HK_OK;
}

/* The first place of particle i or one above it. */
static size_t first_place(const hk_pins *pins, size_t i) {
  size_t low = 0, high = pins->places;
  while (low < high) {
    size_t middle = (low + high) / 2;
    if (pins->place[middle].particle < i)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

void hk_pins_close(hk_pins *pins) {
  for (size_t k = 0; k < pins->count; k++) {
    free(pins->item[k].index);
    free(pins->item[k].origin);
    free(pins->item[k].motion);
  }
  free(pins->item);
  free(pins->place);
}

/* Projects `vector` onto the directions that the pin allows. */
void hk_pin_project(const hk_pin_spec *spec, double vector[3]) {
  const double *a = spec->axis;
  double along = a[0] * vector[0] + a[1] * vector[1] + a[2] * vector[2];
  for (int c = 0; c < 3; c++) vector[c] = spec->kind == HK_PIN_LINE ? along * a[c] : vector[c] - along * a[c];
}

static void impose_slide(const hk_pin_state *pin, const double origin[3], double position[3], double velocity[3]) {
  double offset[3];
  for (int c = 0; c < 3; c++) offset[c] = position[c] - origin[c];
  hk_pin_project(pin->spec, offset);
  for (int c = 0; c < 3; c++) position[c] = origin[c] + offset[c];
  hk_pin_project(pin->spec, velocity);
}

hk_status hk_pins_find(const hk_pins *pins, double t, hk_error *error) {
  hk_status status = HK_OK;
  for (size_t k = 0; k < pins->count && status == HK_OK; k++)
    if (!pins->item[k].released && pins->item[k].spec->kind == HK_PIN_PATH)
      status = pins->item[k].motion->find(pins->item[k].motion, t, error);
  return status;
}

void hk_pins_impose(const hk_pins *pins, size_t begin, size_t end, double *x, double *v) {
  for (size_t k = first_place(pins, begin); k < pins->places && pins->place[k].particle < end; k++) {
    const hk_pin_state *pin = &pins->item[pins->place[k].pin];
    size_t i = pins->place[k].particle;
    const double *origin = pin->origin + 3 * (size_t)pins->place[k].member;
    if (pin->released) continue;
    if (pin->spec->kind == HK_PIN_PATH)
      hk_pin_motion_place(pin->motion, origin, x + 3 * i, v + 3 * i);
    else
      impose_slide(pin, origin, x + 3 * i, v + 3 * i);
  }
}

void hk_pins_slide(const hk_pins *pins, size_t begin, size_t end, double *vector) {
  for (size_t k = first_place(pins, begin); k < pins->places && pins->place[k].particle < end; k++) {
    const hk_pin_state *pin = &pins->item[pins->place[k].pin];
    if (!pin->released && pin->spec->kind != HK_PIN_PATH)
      hk_pin_project(pin->spec, vector + 3 * (size_t)pins->place[k].particle);
  }
}

void hk_pins_filter(const hk_pins *pins, double *vector) {
  for (size_t k = 0; k < pins->count; k++) {
    const hk_pin_state *pin = &pins->item[k];
    bool slides = pin->spec->kind == HK_PIN_LINE || pin->spec->kind == HK_PIN_PLANE;
    for (size_t j = 0; !pin->released && j < pin->count; j++) {
      double *part = vector + 3 * pin->index[j];
      if (slides)
        hk_pin_project(pin->spec, part);
      else
        memset(part, 0, 3 * sizeof *part);
    }
  }
}

double hk_pins_power(const hk_pins *pins, size_t begin, size_t end, const double *F, const double *v) {
  double power = 0;
  for (size_t k = first_place(pins, begin); k < pins->places && pins->place[k].particle < end; k++) {
    const hk_pin_state *pin = &pins->item[pins->place[k].pin];
    size_t i = 3 * (size_t)pins->place[k].particle;
    if (pin->released || pin->spec->kind != HK_PIN_PATH) continue;
    for (size_t c = i; c < i + 3; c++) power -= F[c] * v[c];
  }
  return power;
}

void hk_pins_remap(hk_pins *pins, const uint32_t *map) {
  for (size_t k = 0; k < pins->count; k++) {
    hk_pin_state *pin = &pins->item[k];
    size_t kept = 0;
    for (size_t j = 0; j < pin->count; j++) {
      if (map[pin->index[j]] == UINT32_MAX) continue;
      memmove(pin->origin + 3 * kept, pin->origin + 3 * j, 3 * sizeof *pin->origin);
      pin->index[kept++] = map[pin->index[j]];
    }
    pin->count = kept;
  }
  list_places(pins);
}

double hk_pins_speed_error(const hk_pins *pins) {
  double most = 0;
  for (size_t k = 0; k < pins->count; k++)
    if (pins->item[k].motion) most = fmax(most, pins->item[k].motion->speed_error);
  return most;
}

bool hk_pins_release_at(const hk_pins *pins, double t) {
  for (size_t k = 0; k < pins->count; k++)
    if (!pins->item[k].released && t >= pins->item[k].spec->release) return true;
  return false;
}

void hk_pins_release(hk_pins *pins, hk_state *state) {
  pins->has_paths = pins->has_slides = false;
  for (size_t k = 0; k < pins->count; k++) {
    hk_pin_state *pin = &pins->item[k];
    bool now = !pin->released && state->t >= pin->spec->release;
    for (size_t j = 0; now && j < pin->count; j++) state->pin[pin->index[j]] = HK_FREE;
    pin->released |= now;
    if (pin->released) continue;
    pins->has_paths |= pin->spec->kind == HK_PIN_PATH;
    pins->has_slides |= pin->spec->kind == HK_PIN_LINE || pin->spec->kind == HK_PIN_PLANE;
  }
  hk_state_refresh(state);
}
