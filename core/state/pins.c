/* Pins: what a particle may not do. Fixed and scripted particles have no inverse mass, so no force moves them; sliding
 * ones have the forbidden part of a vector projected away. A scripted particle is put on its path before every
 * evaluation, at that evaluation's time, so that a method keeps its order with moving boundaries. */
#include "core/run/engine.h"

#include <stdlib.h>
#include <string.h>

static hk_status open_pin(hk_run *run, hk_pin_state *pin) {
  const hk_pin_spec *spec = pin->spec;
  pin->index = malloc((spec->count + 1) * sizeof *pin->index);
  pin->origin = malloc((spec->count + 1) * 3 * sizeof *pin->origin);
  if (!pin->index || !pin->origin) return hk_error_set(&run->error, HK_NO_MEMORY, "no memory for the pins");
  for (size_t k = 0; k < spec->count; k++) {
    uint32_t i;
    if (!hk_run_index(run, spec->id[k], &i)) continue; /* died before the checkpoint that the run starts from */
    if (run->pin[i] != HK_FREE)
      return hk_error_set(&run->error, HK_BAD_PARAM, "%s: pin: particle %u is pinned twice", spec->where, spec->id[k]);
    if (run->mass[i] == 0 && isfinite(spec->release))
      return hk_error_set(&run->error, HK_BAD_PARAM, "%s: pin: particle %u has no mass and cannot be released",
                          spec->where, spec->id[k]);
    run->pin[i] = (uint8_t)spec->kind;
    pin->index[pin->count] = i;
    memcpy(pin->origin + 3 * pin->count++, run->scene->position + 3 * (spec->id[k] - 1), 3 * sizeof(double));
    if (spec->kind == HK_PIN_FIXED) memset(run->X + 3 * (run->model.n + i), 0, 3 * sizeof(double));
  }
  return HK_OK;
}

hk_status hk_pins_open(hk_run *run) {
  const hk_scene *scene = run->scene;
  run->imposed_t = NAN;
  run->pin_state = calloc(scene->pins + 1, sizeof *run->pin_state);
  if (!run->pin_state) return hk_error_set(&run->error, HK_NO_MEMORY, "no memory for the pins");
  for (run->pins = 0; run->pins < scene->pins;) {
    hk_pin_state *pin = &run->pin_state[run->pins++];
    pin->spec = &scene->pin[run->pins - 1];
    hk_status status = open_pin(run, pin);
    if (status != HK_OK) return status;
    run->has_paths |= pin->spec->kind == HK_PIN_PATH;
    run->has_slides |= pin->spec->kind == HK_PIN_LINE || pin->spec->kind == HK_PIN_PLANE;
  }
  for (size_t k = 0; k < scene->force.count; k++) run->has_timed |= scene->force.item[k]->timed_count > 0;
  return HK_OK;
}

void hk_pins_close(hk_run *run) {
  for (size_t k = 0; k < run->pins; k++) {
    free(run->pin_state[k].index);
    free(run->pin_state[k].origin);
  }
  free(run->pin_state);
}

/* The offset and velocity of a path at t; the velocity by central differences when the script gives none. Their step
 * balances truncation h^2 against rounding eps/h: eps^(1/3) of a second, or of t when that is larger. */
static hk_status path_at(hk_run *run, const hk_pin_spec *spec, double t, double out[6]) {
  double before[6] = {0}, after[6] = {0}, h = 6e-6 * fmax(1, fabs(t)), early = t - h, late = t + h;
  size_t got = 0;
  hk_status status = spec->path.call(&spec->path, &t, 1, out, 6, &got, &run->error);
  if (status != HK_OK) return status;
  for (size_t k = 0; k < got; k++)
    if (!isfinite(out[k]))
      return hk_error_set(&run->error, HK_SCRIPT, "%s: pin: the path is not finite at t = %g s", spec->where, t);
  if (got == 6) return HK_OK;
  if (got != 3)
    return hk_error_set(&run->error, HK_SCRIPT,
                        "%s: pin: the path gave %zu numbers at t = %g s, expected x, y, z [, vx, vy, vz]", spec->where,
                        got, t);
  size_t count = 0;
  status = spec->path.call(&spec->path, &early, 1, before, 6, &count, &run->error);
  if (status == HK_OK) status = spec->path.call(&spec->path, &late, 1, after, 6, &count, &run->error);
  for (int c = 0; c < 3; c++) out[3 + c] = (after[c] - before[c]) / (late - early);
  return status;
}

static hk_status impose_path(hk_run *run, const hk_pin_state *pin, double t, double *x, double *v) {
  double at[6];
  hk_status status = path_at(run, pin->spec, t, at);
  for (size_t k = 0; status == HK_OK && k < pin->count; k++)
    for (int c = 0; c < 3; c++) {
      x[3 * pin->index[k] + c] = pin->origin[3 * k + c] + at[c];
      v[3 * pin->index[k] + c] = at[3 + c];
    }
  return status;
}

/* Keeps of `vector` what the pin allows. */
static void project(const hk_pin_spec *spec, double *vector) {
  const double *a = spec->axis;
  double along = a[0] * vector[0] + a[1] * vector[1] + a[2] * vector[2];
  for (int c = 0; c < 3; c++) vector[c] = spec->kind == HK_PIN_LINE ? along * a[c] : vector[c] - along * a[c];
}

static void impose_slide(const hk_pin_state *pin, double *x, double *v) {
  for (size_t k = 0; k < pin->count; k++) {
    double *position = x + 3 * pin->index[k], offset[3];
    for (int c = 0; c < 3; c++) offset[c] = position[c] - pin->origin[3 * k + c];
    project(pin->spec, offset);
    for (int c = 0; c < 3; c++) position[c] = pin->origin[3 * k + c] + offset[c];
    project(pin->spec, v + 3 * pin->index[k]);
  }
}

hk_status hk_pins_impose(hk_run *run, double t, double *x, double *v) {
  if (!run->has_paths && !run->has_slides && !run->has_timed) return HK_OK;
  hk_status status = HK_OK;
  for (size_t k = 0; k < run->pins && status == HK_OK; k++) {
    const hk_pin_state *pin = &run->pin_state[k];
    if (pin->released) continue;
    if (pin->spec->kind == HK_PIN_PATH)
      status = impose_path(run, pin, t, x, v);
    else if (pin->spec->kind != HK_PIN_FIXED)
      impose_slide(pin, x, v);
  }
  if (run->has_timed && t != run->imposed_t)
    for (size_t k = 0; k < run->scene->force.count && status == HK_OK; k++)
      status = hk_instance_set_time(run->scene->force.item[k], t, &run->error);
  run->imposed_t = status == HK_OK ? t : NAN;
  return status;
}

void hk_pins_filter(const hk_run *run, double *vector) {
  for (size_t k = 0; k < run->pins; k++) {
    const hk_pin_state *pin = &run->pin_state[k];
    bool slides = pin->spec->kind == HK_PIN_LINE || pin->spec->kind == HK_PIN_PLANE;
    for (size_t j = 0; !pin->released && j < pin->count; j++) {
      double *part = vector + 3 * pin->index[j];
      if (slides)
        project(pin->spec, part);
      else
        memset(part, 0, 3 * sizeof *part);
    }
  }
}

double hk_pins_power(const hk_run *run, const double *F, const double *v) {
  double power = 0;
  for (size_t k = 0; k < run->pins; k++) {
    const hk_pin_state *pin = &run->pin_state[k];
    if (pin->released || pin->spec->kind != HK_PIN_PATH) continue;
    for (size_t j = 0; j < pin->count; j++)
      for (int c = 0; c < 3; c++) power -= F[3 * pin->index[j] + c] * v[3 * pin->index[j] + c];
  }
  return power;
}

void hk_pins_remap(hk_run *run, const uint32_t *map) {
  for (size_t k = 0; k < run->pins; k++) {
    hk_pin_state *pin = &run->pin_state[k];
    size_t kept = 0;
    for (size_t j = 0; j < pin->count; j++) {
      if (map[pin->index[j]] == UINT32_MAX) continue;
      memmove(pin->origin + 3 * kept, pin->origin + 3 * j, 3 * sizeof *pin->origin);
      pin->index[kept++] = map[pin->index[j]];
    }
    pin->count = kept;
  }
}

bool hk_pins_release(hk_run *run) {
  bool any = false;
  run->has_paths = run->has_slides = false;
  for (size_t k = 0; k < run->pins; k++) {
    hk_pin_state *pin = &run->pin_state[k];
    bool now = !pin->released && run->system.t >= pin->spec->release;
    for (size_t j = 0; now && j < pin->count; j++) {
      run->pin[pin->index[j]] = HK_FREE;
      run->inverse_mass[pin->index[j]] = 1 / run->mass[pin->index[j]];
    }
    pin->released |= now;
    any |= now;
    if (pin->released) continue;
    run->has_paths |= pin->spec->kind == HK_PIN_PATH;
    run->has_slides |= pin->spec->kind == HK_PIN_LINE || pin->spec->kind == HK_PIN_PLANE;
  }
  return any;
}
