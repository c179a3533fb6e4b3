/* Liquid that comes through a wall: a rectangle on a face of the box of the corrector `liquid`, or on that of an
 * obstacle which fits its grid, moves liquid into the domain with a speed. The pressure has that speed as the wall's
 * (plugins/common/emission/inflows.h), and the particles of what comes are born here.
 *
 * The rectangle is divided into places half a cell wide, two a cell along each axis. Each place bears a particle
 * whenever the flow has gone on by half a cell, at birth k at from + (k + phase) cell/(2 speed), with its part of the
 * mass: so the mass that is in is density x area x speed x time, to half a particle a place, for any step. Phases are
 * Kronecker's sequence of the places, {1/2 + i/f + j/f^2} with f^3 = f + 1 (Roberts 2018, The unreasonable
 * effectiveness of quasirandom sequences), so that births are even in time; in its place a particle is at random in the
 * middle 0.4, drawn from the seed and the number of the birth (draw.h). Frames have the same particles, with the same
 * ids, for any length of the steps and any number of threads. */
#include "plugins/common/channels/find_channel.h"
#include "plugins/common/emission/draw.h"
#include "plugins/common/emission/inflows.h"

typedef struct inflow {
  double low[3], high[3], direction[3], speed, density, cell, from, to, amount;
  const char *channel;
  hk_inflow opening;
  const hk_inflows *all;
  size_t places[3];        /* along each axis; 1 along that of the flow */
  double place[3], period; /* m, of one; s, between its births */
  double mass;             /* kg, of a newborn */
  double *initial;         /* of the channels of a newborn; NULL: there are none */
  int64_t seed;
  double reached; /* s: births until then were */
  int64_t said;
  const hk_host *host;
} inflow;

static const double scatter = 0.4;      /* of a place */
static const double most_places = 1e6;  /* of one rectangle */
static const double along_axis = 1e-12; /* of the direction's length, beside an axis */

static const hk_param params[] = {
    {"low", "m", "a corner of the rectangle that liquid comes through, on a wall: the same along the direction",
     .vector = HK_AT(inflow, low), .flags = HK_REQUIRED},
    {"high", "m", "the other corner; in a plane liquid the rectangle is a line", .vector = HK_AT(inflow, high),
     .flags = HK_REQUIRED},
    {"direction", "", "from the wall into the liquid, along an axis", .vector = HK_AT(inflow, direction),
     .initial = {1, 0, 0}},
    {"speed", "m/s", "with which it comes", .number = HK_AT(inflow, speed), .limits = HK_ABOVE(0),
     .flags = HK_REQUIRED},
    {"cell", "m", "of the corrector liquid: particles are half of it apart", .number = HK_AT(inflow, cell),
     .limits = HK_ABOVE(0), .flags = HK_REQUIRED},
    {"density", "kg/m^3", "of the liquid", .number = HK_AT(inflow, density), .initial = {1000}, .limits = HK_ABOVE(0)},
    {"from", "s", "time at which it begins", .number = HK_AT(inflow, from)},
    {"to", "s", "time at which it ends; left out: never", .number = HK_AT(inflow, to), .flags = HK_OPTIONAL},
    {"channel", "", "a channel of size 1 that newborns have an amount of, such as 'temperature'",
     .string = HK_AT(inflow, channel)},
    {"amount", "", "of a newborn in that channel", .number = HK_AT(inflow, amount), .initial = {1}},
    {0},
};

static const hk_field fields[] = {
    {"seed", .integer = HK_AT(inflow, seed)},
    {"reached", .number = HK_AT(inflow, reached)},
    {"said", .integer = HK_AT(inflow, said)},
    {0},
};

static hk_status find_axis(inflow *s) {
  double length = 0, most = 0;
  int axis = 0;
  for (int c = 0; c < 3; c++) {
    length += s->direction[c] * s->direction[c];
    if (fabs(s->direction[c]) > most) axis = c, most = fabs(s->direction[c]);
  }
  if (!(most > 0) || sqrt(length) - most > along_axis * most)
    return s->host->fail(s->host, HK_BAD_PARAM,
                         "direction: { %g, %g, %g } is not along an axis, and walls that liquid comes through are "
                         "across one: give { 1, 0, 0 }, { 0, 0, -1 } and the like",
                         s->direction[0], s->direction[1], s->direction[2]);
  s->opening.axis = axis;
  s->opening.speed = s->direction[axis] > 0 ? s->speed : -s->speed;
  return HK_OK;
}

/* Places of half a cell, or a little more or less, for whole numbers of them. Along an axis without extent there is one
 * place, a cell deep: the liquid is a plane one. */
static hk_status divide(inflow *s) {
  double all = 1;
  int without = 0;
  for (int c = 0; c < 3; c++) {
    double long_by = s->high[c] - s->low[c];
    s->places[c] = 1;
    s->place[c] = long_by > 0 ? long_by : s->cell;
    if (c == s->opening.axis) {
      if (long_by != 0)
        return s->host->fail(s->host, HK_BAD_PARAM,
                             "low and high differ by %g m along %c, the direction, where the rectangle is flat: give "
                             "the place of the wall in both",
                             long_by, "xyz"[c]);
      s->place[c] = s->cell / 2;
      continue;
    }
    if (!(long_by >= 0))
      return s->host->fail(s->host, HK_BAD_PARAM, "high: %g m is below low, %g m, along %c: give the upper corner",
                           s->high[c], s->low[c], "xyz"[c]);
    without += long_by == 0;
    double places = long_by > 0 ? fmax(1, floor(2 * long_by / s->cell + 0.5)) : 1;
    if (long_by > 0 && long_by < s->cell / 4)
      return s->host->fail(s->host, HK_BAD_PARAM,
                           "it is %g m wide along %c, less than half of a particle's place of %g m: take smaller "
                           "cells, or a wider one",
                           long_by, "xyz"[c], s -> cell / 2);
    all *= places;
    s->places[c] = (size_t)fmin(places, most_places);
    s->place[c] /= places;
  }
  if (without == 2)
    return s->host->fail(s->host, HK_BAD_PARAM,
                         "low and high are one point, and nothing comes through it: give two corners of a rectangle");
  if (!(all <= most_places))
    return s->host->fail(s->host, HK_BAD_PARAM,
                         "it has %g places of half a cell, and %g is the most: take larger cells", all, most_places);
  return HK_OK;
}

static hk_status set_initial(inflow *s, const hk_model *model) {
  const hk_channel *found = NULL;
  size_t width = 0;
  if (!s->channel) return HK_OK;
  hk_status status = hk_find_channel(s->host, model, s->channel, "channel", 1, &found);
  if (status != HK_OK) return status;
  for (size_t k = 0; k < model->channels; k++) width += model->channel[k].size;
  s->initial = s->host->allocate(s->host, width * sizeof *s->initial);
  if (!s->initial) return s->host->fail(s->host, HK_NO_MEMORY, "no memory for %zu channels", width);
  for (size_t k = 0; k < width; k++) s->initial[k] = NAN;
  s->initial[found->offset] = s->amount;
  return HK_OK;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  inflow *s = self;
  s->host = host;
  s->seed = (int64_t)(host->random(host) * 0x1p53);
  s->reached = view->t;
  if (isnan(s->to)) s->to = INFINITY;
  if (!(s->to > s->from)) return host->fail(host, HK_BAD_PARAM, "to: %g s is not after from: %g s", s->to, s->from);
  hk_status status = find_axis(s);
  if (status == HK_OK) status = divide(s);
  if (status == HK_OK) status = set_initial(s, view->model);
  if (status != HK_OK) return status;
  s->mass = s->density * s->place[0] * s->place[1] * s->place[2];
  s->period = s->place[s->opening.axis] / s->speed;
  for (int c = 0; c < 3; c++) s->opening.low[c] = s->low[c], s->opening.high[c] = s->high[c];
  s->opening.density = s->density;
  s->opening.from = s->from;
  s->opening.to = s->to;
  s->all = host->query(host, HK_INFLOWS_INTERFACE);
  return s->all ? s->all->enter(s->all->self, &s->opening) : HK_FAILED;
}

static void destroy(void *self, const hk_host *host) { host->release(host, ((inflow *)self)->initial); }

/* Of birth 0, in periods. i, j: of the place. */
static double phase_of(size_t i, size_t j) {
  double sum = 0.5 + 0.7548776662466927 * (double)i + 0.5698402909980532 * (double)j;
  return sum - floor(sum);
}

/* Births of a place until the time t. */
static double births_until(const inflow *s, double t, double phase) {
  return fmax(0, floor((fmin(t, s->to) - s->from) / s->period - phase) + 1);
}

static hk_status bear(const inflow *s, hk_population *population, const size_t at[3], uint64_t number, double age) {
  hk_draw d = hk_draw_begin((uint64_t)s->seed, number);
  hk_birth birth = {.mass = s->mass, .channel = s->initial};
  for (int c = 0; c < 3; c++) {
    double random = scatter * (hk_draw_uniform(&d) - 0.5);
    bool across = s->high[c] > s->low[c];
    birth.position[c] = across ? s->low[c] + ((double)at[c] + 0.5 + random) * s->place[c] : s->low[c];
  }
  birth.velocity[s->opening.axis] = s->opening.speed;
  return population->add_aged(population, &birth, age, INFINITY, NULL);
}

static hk_status emit(void *self, const hk_view *view, double h, hk_population *population) {
  inflow *s = self;
  int a = s->opening.axis == 0 ? 1 : 0, b = 3 - s->opening.axis - a;
  (void)h;
  if (!s->all->taken && s->said++ == 0)
    s->host->warn(s->host, "there is no corrector liquid in whose wall it could be, and what comes is loose particles: "
                           "add one, or take the source emitter");
  hk_status status = HK_OK;
  for (size_t i = 0; i < s->places[a]; i++)
    for (size_t j = 0; j < s->places[b] && status == HK_OK; j++) {
      size_t at[3] = {0};
      at[a] = i, at[b] = j;
      double phase = phase_of(i, j), done = births_until(s, s->reached, phase);
      double until = births_until(s, view->t, phase);
      for (double k = done; k < until && status == HK_OK; k++) {
        uint64_t number = (uint64_t)k * s->places[a] * s->places[b] + i * s->places[b] + j;
        status = bear(s, population, at, number, fmax(0, view->t - s->from - (k + phase) * s->period));
      }
    }
  s->reached = fmax(s->reached, view->t);
  return status;
}

static const hk_source source = {.size = sizeof(hk_source), .emit = emit, .flags = HK_AFTER_STEPS};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_SOURCE,
    .name = "inflow",
    .summary = "lets liquid in through a rectangle of a wall, with a speed that the pressure of `liquid` knows",
    .reference =
        "Bridson 2015, Fluid simulation for computer graphics, chapter 5 (walls with a velocity); Roberts 2018 "
        "(even births)",
    .instance_size = sizeof(inflow),
    .params = params,
    .fields = fields,
    .create = create,
    .destroy = destroy,
    .source = &source,
};
