/* A scene as hooke reads it. Numbers have 17 digits, which restore every double. */
#include "tests/adversary/adversary.h"

#include <math.h>
#include <stdarg.h>

double adv_scene_end(const adv_scene *s) { return s->frames / s->fps; }

static void write_vector(const char *name, const double v[3], FILE *out) {
  fprintf(out, "%s = { %.17g, %.17g, %.17g }", name, v[0], v[1], v[2]);
}

/* A local function that holds its numbers; returns its name, valid until the next call. */
static const char *write_wave(const adv_wave *f, int *count, FILE *out) {
  static char name[16];
  snprintf(name, sizeof name, "f%d", ++*count);
  fprintf(out, "local %s, %s_rate\ndo\n", name, name);
  adv_wave_write(f, name, out);
  fprintf(out, "end\n");
  return name;
}

/* A number where nothing changes, so that hooke need not look for changes. */
static void write_timed(const char *key, const adv_vector *v, int wave, FILE *out) {
  double constant[3];
  for (int c = 0; c < 3; c++) constant[c] = v->base[c] + v->along[c] * v->wave.b;
  if (v->wave.shape == ADV_CONSTANT) {
    fprintf(out, ", "), write_vector(key, constant, out);
    return;
  }
  fprintf(out, ", %s = function(t) local f = f%d(t) return {", key, wave);
  for (int c = 0; c < 3; c++) fprintf(out, "%s %.17g + %.17g * f", c ? "," : "", v->base[c], v->along[c]);
  fprintf(out, " } end");
}

static void write_pairs(const adv_force *f, const char *length, FILE *out) {
  fprintf(out, "edges = {");
  for (int e = 0; e < f->edges; e++) fprintf(out, " { %d, %d },", f->edge[e][0] + 1, f->edge[e][1] + 1);
  fprintf(out, " }, %s = {", length);
  for (int e = 0; e < f->edges; e++) fprintf(out, " %.17g,", f->rest[e]);
  fprintf(out, " }");
}

static void write_bars(const adv_force *f, FILE *out) {
  fprintf(out, "scene:constraint('bars', { "), write_pairs(f, "length", out), fprintf(out, " })\n");
}

static void write_edges(const adv_force *f, FILE *out) {
  fprintf(out, ", "), write_pairs(f, "rest", out);
  fprintf(out, ", k = %.17g", f->k);
  if (f->law != ADV_CUBIC) fprintf(out, ", damping = %.17g", f->damping);
}

static void write_central(const adv_force *f, int centre, int strength, FILE *out) {
  write_timed("center", &f->vector, centre, out);
  if (f->strength.shape == ADV_CONSTANT)
    fprintf(out, ", strength = %.17g", f->strength.b);
  else
    fprintf(out, ", strength = f%d", strength);
  fprintf(out, ", power = %.17g, softening = %.17g, per = '%s'", f->power, f->softening,
          f->per_mass ? "mass" : "particle");
}

static void write_force(const adv_scene *s, const adv_force *f, int *waves, FILE *out) {
  static const char *const names[] = {"gravity", "drag", "springs", "ropes", "cubic_springs", "central", "magnetic"};
  if (f->law == ADV_BARS) {
    write_bars(f, out);
    return;
  }
  bool timed = f->law == ADV_GRAVITY || f->law == ADV_CENTRAL || f->law == ADV_MAGNETIC;
  if (timed) write_wave(&f->vector.wave, waves, out);
  int vector = *waves;
  if (f->law == ADV_CENTRAL) write_wave(&f->strength, waves, out);
  fprintf(out, "scene:force('%s', { from = %.17g", names[f->law], f->from);
  if (f->to < INFINITY) fprintf(out, ", to = %.17g", f->to);
  if (f->only) fprintf(out, ", only = {");
  for (int i = 0; f->only && i < s->n; i++)
    if (f->only >> i & 1) fprintf(out, " %d,", i + 1);
  if (f->only) fprintf(out, " }");
  switch (f->law) {
  case ADV_GRAVITY:
    write_timed("g", &f->vector, vector, out);
    break;
  case ADV_DRAG:
    fprintf(out, ", %s = %.17g", f->per_mass ? "rate" : "d", f->amount);
    break;
  case ADV_MAGNETIC:
    write_timed("B", &f->vector, vector, out);
    fprintf(out, ", %s = %.17g", f->per_mass ? "ratio" : "charge", f->amount);
    break;
  case ADV_CENTRAL:
    write_central(f, vector, *waves, out);
    break;
  case ADV_SPRINGS:
  case ADV_ROPES:
  case ADV_CUBIC:
    write_edges(f, out);
    break;
  case ADV_BARS:
    break;
  }
  fprintf(out, " })\n");
}

static void write_pin(const adv_pin *p, int *waves, FILE *out) {
  double axis[3] = {p->axis == 0, p->axis == 1, p->axis == 2};
  if (p->hold == ADV_PATH) write_wave(&p->path.wave, waves, out);
  fprintf(out, "scene:pin({ %d }, { ", p->particle + 1);
  if (p->hold == ADV_LINE) write_vector("axes", axis, out);
  if (p->hold == ADV_PLANE) write_vector("normal", axis, out);
  if (p->hold == ADV_PATH) {
    fprintf(out, "path = function(t) local f, r = f%d(t), f%d_rate(t) return ", *waves, *waves);
    for (int c = 0; c < 3; c++) fprintf(out, "%s%.17g + %.17g * f", c ? ", " : "", p->path.base[c], p->path.along[c]);
    for (int c = 0; c < 3 && p->tells_velocity; c++) fprintf(out, ", %.17g * r", p->path.along[c]);
    fprintf(out, " end");
  }
  if (p->release < INFINITY) fprintf(out, "%srelease = %.17g", p->hold == ADV_FIXED ? "" : ", ", p->release);
  fprintf(out, " })\n");
}

static void write_list(const double *number, int count, FILE *out) {
  for (int k = 0; k < count; k++) fprintf(out, "%s%.17g", k ? ", " : "", number[k]);
}

static void write_channel(const adv_scene *s, FILE *out) {
  static const char *const rates[] = {
      "", "function(t, id, x) return -r1 * x end", "function(t, id, x) return -r1 * (x - math.cos(r2 * t)) end",
      "function(t, id, x, y, z) local a, b, c = r1 * x, r2 * y * y, r3 * y * z return c - a, a - b - c, b end",
      "function(t, id, x, y) return y, r1 * (1 - x * x) * y - r2 * x end"};
  if (s->kinetics == ADV_NO_CHANNEL) return;
  fprintf(out, "local r1, r2, r3 = "), write_list(s->rate, ADV_SIZE, out);
  fprintf(out, "\nscene:channel('y', { size = %d, initial = { ", s->size), write_list(s->initial, s->size, out);
  fprintf(out, " }, rate = %s })\n", rates[s->kinetics]);
}

static void write_measures(const adv_scene *s, FILE *out) {
  for (int i = 1; i <= s->n; i++)
    for (int c = 1; c <= 3; c++)
      fprintf(out, "scene:measure('x%d_%d', function(s) return s:position(%d)[%d] end)\n", i, c, i, c);
  for (int i = 1; i <= s->n && s->size > 0; i++)
    for (int c = 1; c <= s->size; c++)
      fprintf(out,
              s->size == 1 ? "scene:measure('y%d_%d', function(s) local y = s:channel('y', %d) return type(y) == "
                             "'table' and y[%d] or y end)\n"
                           : "scene:measure('y%d_%d', function(s) return s:channel('y', %d)[%d] end)\n",
              i, c, i, c);
}

void adv_scene_write(const adv_scene *from, double accuracy, FILE *out) {
  int waves = 0;
  adv_scene scaled, *s = &scaled;
  adv_scene_in_units(from, s);
  accuracy *= from->units.length;
  fprintf(out, "local scene = hooke.scene { duration = %.17g, fps = %.17g", adv_scene_end(s), s->fps);
  if (isfinite(s->dt)) fprintf(out, ", dt = %.17g", s->dt);
  if (isfinite(s->tol)) fprintf(out, ", tol = %.17g", s->tol);
  if (isfinite(accuracy)) fprintf(out, ", accuracy = %.17g", accuracy);
  fprintf(out, " }\n");
  for (int i = 0; i < s->n; i++) {
    fprintf(out, "scene:particle { "), write_vector("position", s->x[i], out);
    fprintf(out, ", "), write_vector("velocity", s->v[i], out);
    fprintf(out, ", mass = %.17g }\n", s->mass[i]);
  }
  for (int k = 0; k < s->pins; k++) write_pin(&s->pin[k], &waves, out);
  for (int k = 0; k < s->forces; k++) write_force(s, &s->force[k], &waves, out);
  write_channel(s, out);
  write_measures(s, out);
  fprintf(out, "return scene\n");
}
