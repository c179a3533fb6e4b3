/* Positions and channels of a run at its frames. When they need more memory than `most_numbers`, every second frame is
 * dropped, and from then on only every second one is kept; the end of the run is always kept. */
#include "core/run/judge/judge.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

struct hk_moment {
  double t;
  size_t frame, n, begin, size; /* begin and size: of its numbers in `value` */
};

static const size_t most_numbers = (size_t)1 << 24; /* 128 MiB */
static const size_t most_stride = SIZE_MAX / 4;     /* more frames than there will ever be */

static hk_status no_memory(hk_error *error) {
  return hk_error_set(error, HK_NO_MEMORY,
                      "no memory for the positions at the frames, from which the accuracy is judged");
}

/* Keeps the moments whose frames are multiples of the doubled stride. */
static void drop_half(hk_trajectory *a) {
  size_t kept = 0, size = 0;
  a->stride *= 2;
  for (size_t k = 0; k < a->moments; k++) {
    struct hk_moment m = a->moment[k];
    if (m.frame % a->stride) continue;
    memmove(a->value + size, a->value + m.begin, m.size * sizeof *a->value);
    m.begin = size;
    size += m.size;
    a->moment[kept++] = m;
  }
  a->moments = kept;
  a->size = size;
}

static bool reserve(hk_trajectory *a, size_t numbers) {
  if (a->moments == a->room) {
    size_t room = a->room ? 2 * a->room : 64;
    struct hk_moment *grown = realloc(a->moment, room * sizeof *grown);
    if (!grown) return false;
    a->moment = grown;
    a->room = room;
  }
  if (a->size + numbers > a->capacity) {
    size_t capacity = a->size + numbers > 2 * a->capacity ? a->size + numbers : 2 * a->capacity;
    double *grown = realloc(a->value, capacity * sizeof *grown);
    if (!grown) return false;
    a->value = grown;
    a->capacity = capacity;
  }
  return true;
}

/* `width` numbers of each particle, in the order of ids. */
static void copy_in_order(double *to, const double *from, size_t width, const hk_model *m) {
  if (!m->by_id) memcpy(to, from, width * m->n * sizeof *to);
  for (size_t k = 0; m->by_id && k < m->n; k++) memcpy(to + width * k, from + width * m->by_id[k], width * sizeof *to);
}

hk_status hk_trajectory_note(hk_trajectory *a, const hk_state *s, size_t frame, bool always, hk_error *error) {
  size_t n = s->model.n, size = (4 + s->width) * n;
  if (a->stride == 0) a->stride = 1;
  a->width = 4 + s->width;
  while (a->moments > 1 && a->size + size > most_numbers && a->stride < most_stride) drop_half(a);
  if (!always && frame % a->stride) return HK_OK;
  if (a->moments && a->moment[a->moments - 1].t == s->t) return HK_OK;
  if (!reserve(a, size + 1)) return no_memory(error); /* the arrays exist without particles, too */
  double *value = a->value + a->size;
  for (size_t k = 0; k < n; k++) value[k] = s->id[hk_model_nth(&s->model, k)];
  copy_in_order(value + n, s->X, 3, &s->model);
  if (!s->model.by_id) memcpy(value + 4 * n, s->X + 6 * n, s->width * n * sizeof *value);
  for (size_t c = 0; s->model.by_id && c < s->model.channels; c++)
    copy_in_order(value + (4 + s->channel[c].offset) * n, s->X + (6 + s->channel[c].offset) * n, s->channel[c].size,
                  &s->model);
  a->moment[a->moments++] = (struct hk_moment){s->t, frame, n, a->size, size};
  a->size += size;
  return HK_OK;
}

void hk_trajectory_free(hk_trajectory *a) {
  free(a->moment);
  free(a->value);
  *a = (hk_trajectory){0};
}

size_t hk_trajectory_bytes(const hk_trajectory *a) { return a->moments * sizeof *a->moment; }

/* Ids are whole numbers that rise, and are used as indices. */
static bool are_ids(const double *id, size_t n, uint32_t next_id) {
  double before = 0;
  for (size_t i = 0; i < n; before = id[i++])
    if (!(id[i] > before) || !(id[i] < next_id) || id[i] != floor(id[i])) return false;
  return true;
}

/* The stride doubles, and so does not become 0; frames do not fall, or none of them would be dropped. */
static bool plausible(const hk_trajectory *a, uint32_t next_id) {
  size_t begin = 0, frame = 0;
  double before = -INFINITY;
  bool fine = a->moments == 0 || (a->stride > 0 && a->stride <= most_stride);
  for (size_t k = 0; k < a->moments && fine; k++) {
    const struct hk_moment *m = &a->moment[k];
    fine = m->begin == begin && m->size <= a->size - begin && m->n == m->size / a->width &&
           m->n * a->width == m->size && m->frame >= frame && isfinite(m->t) && m->t > before &&
           are_ids(a->value + begin, m->n, next_id);
    begin += fine ? m->size : 0;
    before = m->t;
    frame = m->frame;
  }
  return fine && begin == a->size;
}

bool hk_trajectory_restore(hk_trajectory *a, bool keep, const hk_trajectory *stated, uint32_t next_id, void *from,
                           bool (*get)(void *from, void *data, size_t bytes)) {
  size_t moments = stated->moments, size = stated->size;
  if (moments > SIZE_MAX / sizeof *a->moment - 1 || size > SIZE_MAX / sizeof *a->value - 1 ||
      !get(from, NULL, moments * sizeof *a->moment) || !get(from, NULL, size * sizeof *a->value))
    return false;
  hk_trajectory read = *stated;
  read.room = moments + 1, read.capacity = size + 1;
  read.moment = malloc(read.room * sizeof *read.moment);
  read.value = malloc(read.capacity * sizeof *read.value);
  bool fine = read.moment && read.value && get(from, read.moment, moments * sizeof *read.moment) &&
              get(from, read.value, size * sizeof *read.value) && plausible(&read, next_id);
  if (fine && keep && moments > 0) {
    hk_trajectory_free(a);
    *a = read;
  } else
    hk_trajectory_free(&read);
  return fine;
}

/* The RMS difference of two lists of vectors; INFINITY where it is not a number. */
static double rms(const double *a, const double *b, size_t numbers, size_t vectors) {
  double sum = 0;
  for (size_t k = 0; k < numbers; k++) sum += (a[k] - b[k]) * (a[k] - b[k]);
  double result = vectors ? sqrt(sum / (double)vectors) : 0;
  return isnan(result) ? INFINITY : result;
}

static void compare_channels(hk_distance *d, const hk_scene *scene, const double *accuracy, const double *a,
                             const double *b, size_t n) {
  size_t begin = 4 * n;
  for (size_t k = 0; k < scene->particles.channels; k++) {
    size_t numbers = scene->particles.channel[k].size * n;
    double ratio = rms(a + begin, b + begin, numbers, n) / accuracy[k];
    if (ratio > d->channel) {
      d->channel = ratio;
      d->channel_name = scene->particles.channel[k].name;
    }
    begin += numbers;
  }
}

/* Whether the moments have these channels and no other: a script may describe another scene when it is run again. */
static bool has_channels(const hk_trajectory *a, const hk_scene *scene) {
  size_t width = 4;
  for (size_t k = 0; k < scene->particles.channels; k++) width += scene->particles.channel[k].size;
  return a->width == width;
}

/* False: the particles are not the same. */
static bool compare(hk_distance *d, const hk_trajectory *a, const struct hk_moment *p, const hk_trajectory *b,
                    const struct hk_moment *q, const hk_scene *scene, const double *accuracy) {
  const double *x = a->value + p->begin, *y = b->value + q->begin;
  if (p->n != q->n || !has_channels(a, scene) || !has_channels(b, scene) || memcmp(x, y, p->n * sizeof *x) != 0)
    return false;
  double position = rms(x + p->n, y + q->n, 3 * p->n, p->n);
  if (position > d->position) {
    d->position = position;
    d->t = p->t;
  }
  compare_channels(d, scene, accuracy, x, y, p->n);
  return true;
}

hk_distance hk_trajectory_distance(const hk_trajectory *a, const hk_trajectory *b, const hk_scene *scene,
                                   const double *accuracy, double from, double until) {
  hk_distance d = {0};
  size_t j = 0;
  bool any = false, same = true;
  for (size_t k = 0; k < a->moments; k++) {
    if (a->moment[k].t < from || a->moment[k].t > until) continue;
    while (j < b->moments && b->moment[j].t < a->moment[k].t) j++;
    if (j == b->moments || b->moment[j].t != a->moment[k].t) continue;
    any = true;
    same = same && compare(&d, a, &a->moment[k], b, &b->moment[j], scene, accuracy);
  }
  if (!any || !same) d.position = NAN;
  return d;
}

static uint32_t last_id(const hk_trajectory *a) {
  double last = 0;
  for (size_t k = 0; k < a->moments; k++) {
    const struct hk_moment *m = &a->moment[k];
    if (m->n) last = fmax(last, a->value[m->begin + m->n - 1]);
  }
  return (uint32_t)last;
}

/* The largest RMS change of a part of the moments, each particle's since the first moment that has it; `offset` and
 * `width` per particle. NAN: no memory. */
static double change(const hk_trajectory *a, size_t offset, size_t width) {
  const double **first = calloc((size_t)last_id(a) + 1, sizeof *first);
  double most = first ? 0 : NAN;
  for (size_t k = 0; first && k < a->moments; k++) {
    const struct hk_moment *m = &a->moment[k];
    const double *id = a->value + m->begin, *part = id + offset * m->n;
    double sum = 0;
    for (size_t i = 0; i < m->n; i++, part += width) {
      const double **from = &first[(size_t)id[i]];
      if (!*from) *from = part;
      for (size_t c = 0; c < width; c++) sum += (part[c] - (*from)[c]) * (part[c] - (*from)[c]);
    }
    if (m->n) most = fmax(most, isnan(sum) ? INFINITY : sqrt(sum / (double)m->n));
  }
  free(first);
  return most;
}

double hk_trajectory_motion(const hk_trajectory *a) { return change(a, 1, 3); }

double hk_trajectory_reach(const hk_trajectory *a, const hk_state *s) {
  const struct hk_moment *m = a->moment;
  size_t n = s->model.n;
  double sum = 0;
  if (a->moments == 0 || m->n != n || n == 0) return 0;
  const double *id = a->value + m->begin, *from = id + n;
  for (size_t k = 0; k < n; k++) {
    size_t i = hk_model_nth(&s->model, k);
    if (s->id[i] != id[k]) return 0;
    for (size_t c = 0; c < 3; c++) sum += (s->X[3 * i + c] - from[3 * k + c]) * (s->X[3 * i + c] - from[3 * k + c]);
  }
  return isnan(sum) ? INFINITY : sqrt(sum / (double)n);
}

double hk_trajectory_channel_change(const hk_trajectory *a, const hk_scene *scene, size_t channel) {
  size_t offset = 4;
  if (!has_channels(a, scene)) return NAN;
  for (size_t k = 0; k < channel; k++) offset += scene->particles.channel[k].size;
  return change(a, offset, scene->particles.channel[channel].size);
}

/* ---- one particle ---- */

static int by_id(const void *a, const void *b) {
  double i = *(const double *)a, j = *(const double *)b;
  return (i > j) - (i < j);
}

/* NULL: the particle was not there. */
static const double *position(const hk_trajectory *a, size_t k, double id) {
  const struct hk_moment *m = &a->moment[k];
  const double *ids = a->value + m->begin, *found = bsearch(&id, ids, m->n, sizeof *ids, by_id);
  return found ? ids + m->n + 3 * (found - ids) : NULL;
}

/* The mean velocity from moment k to the next. */
static bool slope(const hk_trajectory *a, size_t k, double id, double v[3]) {
  const double *x = position(a, k, id), *y = position(a, k + 1, id);
  for (int c = 0; c < 3 && x && y; c++) v[c] = (y[c] - x[c]) / (a->moment[k + 1].t - a->moment[k].t);
  return x && y;
}

bool hk_trajectory_place(const hk_trajectory *a, uint32_t id, double t, double x[3], double v[3]) {
  size_t k = 0, last = a->moments ? a->moments - 1 : 0;
  double here[3], beside[3];
  if (last == 0) return false;
  for (size_t low = 0, high = last; low < high; k = low) { /* the last of them up to t that has another one behind */
    size_t middle = (low + high + 1) / 2;
    if (middle < last && a->moment[middle].t <= t)
      low = middle;
    else
      high = middle - 1;
  }
  if (!slope(a, k, id, here)) return false;
  double part = (t - a->moment[k].t) / (a->moment[k + 1].t - a->moment[k].t);
  bool late = part > 0.5 && k + 1 < last, early = part < 0.5 && k > 0;
  double weight = (late || early) && slope(a, late ? k + 1 : k - 1, id, beside) ? fabs(part - 0.5) : 0;
  const double *from = position(a, k, id);
  for (int c = 0; c < 3; c++) {
    x[c] = from[c] + here[c] * (t - a->moment[k].t);
    v[c] = weight > 0 ? here[c] + weight * (beside[c] - here[c]) : here[c];
  }
  return true;
}

/* ---- */

double hk_trajectory_time(const hk_trajectory *a, double part) {
  size_t k = (size_t)ceil(part * (double)a->moments);
  return a->moment[k < a->moments ? k : a->moments - 1].t;
}
