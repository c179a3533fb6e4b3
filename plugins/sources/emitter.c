/* Emits particles at a rate and in bursts, and takes them away when their lifetimes are over.
 *
 * The number of births by a time does not depend on the steps (flow.h). All that is random about a birth is drawn from
 * the seed and its own number (draw.h). The emitter is called after each step, for the births and deaths in it, in the
 * order of their times; the host moves the newborn from their births to the present
 * (core/numerics/population/newborns.c), so that a jet has no stripes. Frames have the same particles, with the same
 * ids, for any length of the steps and any number of threads.
 *
 * Means and spreads, both relative to the value: uniform in value (1 +- spread), or lognormal with the mean `value` and
 * the standard deviation spread value, exp(s z - s^2/2) with s^2 = ln(1 + spread^2), the usual distribution of drop
 * sizes (Lefebvre and McDonell, Atomization and Sprays, ch. 3). Reeves, Particle systems, ACM TOG 2 (1983), 91-108. */
#include "plugins/common/channels/find_channel.h"
#include "plugins/common/emission/flow.h"
#include "plugins/common/emission/outlet.h"

#include <string.h>

/* A particle of this emitter, until its death is taken note of: then id is 0. In the order of births. */
typedef struct particle {
  double dies; /* s; INFINITY: never */
  uint32_t id;
} particle;

typedef struct quantity {
  double value, spread; /* value NAN: not given */
} quantity;

typedef struct emitter {
  hk_flow flow;
  int64_t capacity;
  hk_outlet outlet;
  int distribution; /* UNIFORM or LOGNORMAL */
  quantity speed, mass, radius, lifetime, amount;
  double density; /* kg/m^3; NAN: `mass` is meant */
  const char *channel;
  /* of the scene's channels: the numbers before `radius` and `channel`; -1: not given */
  ptrdiff_t radius_at, channel_at;
  size_t width;
  double *initial; /* width, of the channels of a newborn */
  double *soonest; /* for each BLOCK of the list a time before which none of it dies */
  size_t blocks;
  double *dying; /* the times of deaths in a step, increasing, where the emitter may be full */
  size_t dying_room;
  /* evolving */
  int64_t seed, borne, oldest, kept, living, left_out;
  hk_array list; /* particles oldest to oldest + kept - 1 */
} emitter;

enum { UNIFORM, LOGNORMAL };

enum { BLOCK = 256 }; /* particles that are looked at together for deaths */

/* clang-format off */
#define QUANTITY(name, unit, help, initially, ...)                                                                     \
  {#name, unit, help, .number = HK_AT(emitter, name.value), .initial = {initially}, __VA_ARGS__},                      \
  {#name "_spread", "", "spread of " #name ", relative", .number = HK_AT(emitter, name.spread),                        \
   .limits = HK_WITHIN(0, 1)}
/* clang-format on */

static const hk_param params[] = {
    {"rate", "1/s", "births per second; left out: 100", .number = HK_AT(emitter, flow.rate),
     .limits = HK_WITHIN(0, 1e9), .flags = HK_OPTIONAL},
    {"rate_of_time", "1/s", "births per second as a function of time, in the place of `rate`",
     .function = HK_AT(emitter, flow.of_time), .signature = "function(t) -> rate"},
    {"rate_every", "s", "how often that function is asked: the rate is straight between, and a shorter pulse is missed",
     .number = HK_AT(emitter, flow.cell), .initial = {1e-3}, .limits = HK_WITHIN(1e-9, 1e9)},
    {"from", "s", "time of the first birth", .number = HK_AT(emitter, flow.from), .limits = HK_AT_LEAST(0)},
    {"to", "s", "time from which on the rate emits no more; left out: never", .number = HK_AT(emitter, flow.to),
     .limits = HK_AT_LEAST(0), .flags = HK_OPTIONAL},
    {"burst", "", "births at once at each time of burst_at", .integer = HK_AT(emitter, flow.burst),
     .limits = HK_WITHIN(0, 1e8)},
    {"burst_at", "s", "times of the bursts, increasing", .numbers = HK_AT(emitter, flow.burst_at),
     .limits = HK_AT_LEAST(0), .flags = HK_OPTIONAL},
    {"shape", "", "where: at a point, on a line, disc (across the direction) or sphere, in a ball, on triangles",
     .choice = HK_AT(emitter, outlet.shape), .initial = {HK_OUTLET_POINT},
     .choices = "point|line|disc|sphere|ball|triangles"},
    {"position", "m", "the point, one end of the line, or the centre", .vector = HK_AT(emitter, outlet.position)},
    {"end", "m", "other end of the line", .vector = HK_AT(emitter, outlet.end), .initial = {1, 0, 0}},
    {"extent", "m", "radius of disc, sphere and ball", .number = HK_AT(emitter, outlet.radius), .initial = {0.1},
     .limits = HK_AT_LEAST(0)},
    {"triangles", "", "triangles of the scene to emit from, uniformly by area",
     .triangles = HK_AT(emitter, outlet.triangles), .flags = HK_OPTIONAL | HK_NOT_EMPTY},
    {"places", "", "even: spread over the shape in turn, so that a liquid comes in with its density",
     .choice = HK_AT(emitter, outlet.places), .choices = "random|even"},
    {"direction", "", "in which particles leave; on spheres and triangles they leave along the normal",
     .vector = HK_AT(emitter, outlet.direction), .initial = {0, 0, 1}},
    {"cone", "degrees", "largest angle about that direction, uniform by solid angle",
     .number = HK_AT(emitter, outlet.cone), .limits = HK_WITHIN(0, 180)},
    {"distribution", "", "of spreads: uniform within value (1 +- spread), or lognormal, spread being the deviation",
     .choice = HK_AT(emitter, distribution), .initial = {UNIFORM}, .choices = "uniform|lognormal"},
    QUANTITY(speed, "m/s", "of a newborn, relative to its triangle", 1, .limits = HK_AT_LEAST(0)),
    QUANTITY(mass, "kg", "of a newborn", 1e-3, .limits = HK_ABOVE(0)),
    QUANTITY(radius, "m", "of a newborn, in the channel 'radius'; left out: none", 0, .limits = HK_ABOVE(0),
             .flags = HK_OPTIONAL),
    {"density", "kg/m^3", "of a newborn, 4/3 pi radius^3 density being its mass; left out: mass is",
     .number = HK_AT(emitter, density), .limits = HK_ABOVE(0), .flags = HK_OPTIONAL},
    QUANTITY(lifetime, "s", "of a particle; left out: for ever", 0, .limits = HK_ABOVE(0), .flags = HK_OPTIONAL),
    {"channel", "", "a channel of size 1 that newborns have an amount of, such as 'temperature'",
     .string = HK_AT(emitter, channel)},
    QUANTITY(amount, "", "of a newborn in that channel", 1, .flags = 0),
    {"capacity", "", "particles of this emitter alive at a time, at most", .integer = HK_AT(emitter, capacity),
     .initial = {1000000}, .limits = HK_WITHIN(1, 1e9)},
    {0},
};

static const hk_field fields[] = {
    {"seed", .integer = HK_AT(emitter, seed)},
    {"asked", .integer = HK_AT(emitter, flow.asked)},
    {"cells", .integer = HK_AT(emitter, flow.cells)},
    {"born_before", .number = HK_AT(emitter, flow.before)},
    {"rate_at_begin", .number = HK_AT(emitter, flow.begin)},
    {"rate_at_end", .number = HK_AT(emitter, flow.end)},
    {"borne", .integer = HK_AT(emitter, borne)},
    {"bursts", .integer = HK_AT(emitter, flow.bursts)},
    {"oldest", .integer = HK_AT(emitter, oldest)},
    {"kept", .integer = HK_AT(emitter, kept)},
    {"living", .integer = HK_AT(emitter, living)},
    {"left_out", .integer = HK_AT(emitter, left_out)},
    {"list", .array = HK_AT(emitter, list), .width = sizeof(particle)},
    {0},
};

static particle *particles(const emitter *e) { return (particle *)e->list.item + e->oldest; }

/* ---- the start ---- */

/* Births per second: one of the two, or what nobody has asked for. */
static void choose_rate(emitter *e, const hk_host *host) {
  const double by_default = 100;
  bool given = !isnan(e->flow.rate);
  if (given && e->flow.of_time)
    host->warn(host, "rate, %g/s, has no effect: the function rate_of_time takes its place; leave one of them out",
               e->flow.rate);
  if (given || e->flow.of_time) return;
  e->flow.rate = by_default;
  host->warn(host,
             "no rate is given, so that %g particles a second are born: give rate, or rate_of_time, or rate = 0 for "
             "bursts alone",
             by_default);
}

/* How many will be alive at a time, as far as that is known before the run. */
static hk_status check_capacity(const emitter *e, const hk_host *host) {
  double longest = isnan(e->flow.to) ? INFINITY : e->flow.to - e->flow.from,
         life = isnan(e->lifetime.value) ? INFINITY : e->lifetime.value;
  if (e->flow.of_time) return HK_OK; /* it is said when it is reached */
  double alive = e->flow.rate > 0 ? e->flow.rate * fmin(longest, life) : 0;
  if (isinf(alive) || alive <= (double)e->capacity) return HK_OK;
  return host->fail(host, HK_BAD_PARAM, "capacity: %lld particles are too few for %g/s that live %g s, which are %.0f",
                    (long long)e->capacity, e->flow.rate, fmin(longest, life), alive);
}

static hk_status check_radius(const emitter *e, const hk_host *host) {
  if (!isnan(e->density) && isnan(e->radius.value))
    return host->fail(host, HK_BAD_PARAM, "density: the mass follows from a radius, and none is given");
  return HK_OK;
}

static hk_status find_channels(emitter *e, const hk_host *host, const hk_model *model) {
  hk_status status = HK_OK;
  const hk_channel *found = NULL;
  e->radius_at = e->channel_at = -1;
  for (size_t k = 0; k < model->channels; k++) e->width += model->channel[k].size;
  if (!isnan(e->radius.value)) status = hk_find_channel(host, model, "radius", "radius", 1, &found);
  if (found) e->radius_at = (ptrdiff_t)found->offset;
  found = NULL;
  if (status == HK_OK && e->channel) status = hk_find_channel(host, model, e->channel, "channel", 1, &found);
  if (found) e->channel_at = (ptrdiff_t)found->offset;
  return status;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  emitter *e = self;
  e->seed = (int64_t)(host->random(host) * 0x1p53);
  choose_rate(e, host);
  hk_status status = hk_flow_check(&e->flow, host);
  if (status == HK_OK) status = check_capacity(e, host);
  if (status == HK_OK) status = check_radius(e, host);
  if (status == HK_OK) status = find_channels(e, host, view->model);
  if (status == HK_OK) status = hk_outlet_open(&e->outlet, host, view);
  if (status != HK_OK) return status;
  e->initial = host->allocate(host, (e->width + 1) * sizeof *e->initial);
  if (!e->initial) return host->fail(host, HK_NO_MEMORY, "no memory for %zu channels", e->width);
  for (size_t k = 0; k < e->width; k++) e->initial[k] = NAN;
  return HK_OK;
}

static hk_status topology(void *self, const hk_view *view) {
  hk_outlet_topology(&((emitter *)self)->outlet, view);
  return HK_OK;
}

static void destroy(void *self, const hk_host *host) {
  emitter *e = self;
  hk_outlet_close(&e->outlet, host);
  host->release(host, e->initial);
  host->release(host, e->soonest);
  host->release(host, e->dying);
}

/* ---- deaths ---- */

static bool find(const hk_model *model, uint32_t id, uint32_t *index) {
  *index = (uint32_t)hk_model_find(model, id);
  return *index < model->n;
}

/* A call of `emit`. Where the emitter may be full, births and deaths are looked at in the order of their times. */
typedef struct call {
  const hk_view *view;
  hk_population *population;
  bool crowded;
  size_t deaths, gone; /* in e->dying: all, and those before the present birth; with `crowded` only */
} call;

/* A particle dies at the time `at` in the step. */
static void note_death(emitter *e, call *c, double at) {
  size_t k = c->deaths;
  if (!c->crowded) {
    e->living--;
    return;
  }
  for (; k > c->gone && e->dying[k - 1] > at; k--) e->dying[k] = e->dying[k - 1];
  e->dying[k] = at;
  c->deaths++;
}

/* The soonest deaths, from the list as it is, which may have been moved or come from a checkpoint. */
static hk_status index_deaths(emitter *e, const hk_host *host) {
  size_t blocks = e->list.count / BLOCK + 1;
  if (blocks > e->blocks) {
    host->release(host, e->soonest);
    e->soonest = host->allocate(host, blocks * sizeof *e->soonest);
    e->blocks = e->soonest ? blocks : 0;
    if (!e->soonest) return host->fail(host, HK_NO_MEMORY, "no memory for %zu lifetimes", e->list.count);
  }
  for (size_t b = 0; b < e->blocks; b++) e->soonest[b] = INFINITY;
  for (size_t k = (size_t)e->oldest; k < (size_t)(e->oldest + e->kept); k++)
    e->soonest[k / BLOCK] = fmin(e->soonest[k / BLOCK], ((particle *)e->list.item)[k].dies);
  return HK_OK;
}

/* The block's part of the list. */
static hk_status take_dead_of(emitter *e, call *c, size_t block) {
  size_t end = (size_t)(e->oldest + e->kept), k = block * BLOCK > (size_t)e->oldest ? block * BLOCK : (size_t)e->oldest;
  double t = c->view->t, next = INFINITY;
  hk_status status = HK_OK;
  for (; k < end && k < (block + 1) * BLOCK && status == HK_OK; k++) {
    particle *p = (particle *)e->list.item + k;
    uint32_t index;
    if (p->id == 0) continue;
    if (p->dies > t) {
      next = fmin(next, p->dies);
      continue;
    }
    if (find(c->view->model, p->id, &index)) status = c->population->remove(c->population, index);
    note_death(e, c, p->dies);
    p->id = 0;
  }
  e->soonest[block] = next;
  return status;
}

/* Takes away what has died by the view's time. */
static hk_status take_dead(emitter *e, call *c) {
  hk_status status = HK_OK;
  for (size_t b = (size_t)e->oldest / BLOCK; b * BLOCK < (size_t)(e->oldest + e->kept) && status == HK_OK; b++)
    if (e->soonest[b] <= c->view->t) status = take_dead_of(e, c, b);
  while (e->kept > 0 && particles(e)->id == 0) e->oldest++, e->kept--;
  return status;
}

/* ---- births ---- */

static double draw(const emitter *e, const quantity *q, hk_draw *d) {
  double u = hk_draw_uniform(d), z = hk_draw_uniform(d); /* two in any case: the next quantity does not depend on it */
  if (e->distribution == UNIFORM) return q->value * (1 + q->spread * (2 * u - 1));
  double s = sqrt(log1p(q->spread * q->spread));
  return q->value * exp(s * sqrt(-2 * log(u)) * cos(6.283185307179586 * z) - s * s / 2);
}

static hk_birth draw_birth(const emitter *e, const hk_view *view, double age, uint64_t number, double *lifetime) {
  hk_birth birth = {.channel = e->width ? e->initial : NULL};
  hk_draw d = hk_draw_begin((uint64_t)e->seed, number);
  double direction[3];
  hk_outlet_draw(&e->outlet, view, age, number / 2, &d, birth.position, birth.velocity, direction);
  double speed = draw(e, &e->speed, &d), mass = draw(e, &e->mass, &d), radius = draw(e, &e->radius, &d);
  *lifetime = isnan(e->lifetime.value) ? INFINITY : draw(e, &e->lifetime, &d);
  double amount = draw(e, &e->amount, &d);
  for (int c = 0; c < 3; c++) birth.velocity[c] += speed * direction[c];
  birth.mass = isnan(e->density) ? mass : 4.1887902047863905 * radius * radius * radius * e->density; /* 4/3 pi */
  if (e->radius_at >= 0) e->initial[e->radius_at] = radius;
  if (e->channel_at >= 0) e->initial[e->channel_at] = amount;
  return birth;
}

/* Makes room for all births of the step, to which pointers are given away. */
static hk_status reserve(emitter *e, const hk_host *host, double births) {
  double kept = (double)e->kept, wanted = kept + fmin(births, (double)e->capacity + kept);
  if (e->oldest < 0 || e->kept < 0 || (uint64_t)e->oldest > e->list.count ||
      (uint64_t)e->kept > e->list.count - (uint64_t)e->oldest)
    return host->fail(host, HK_FAILED, "the list of its particles is not whole: the checkpoint is damaged");
  if (e->soonest && (double)e->oldest + wanted <= (double)e->list.count) return HK_OK;
  if (e->kept > 0) memmove(e->list.item, particles(e), (size_t)e->kept * sizeof(particle));
  e->oldest = 0;
  hk_status status = HK_OK;
  if (1.5 * wanted > (double)e->list.count) /* with less it would soon have to be moved down again */
    status = host->resize(host, &e->list, (size_t)(2 * wanted) + 1);
  return status == HK_OK ? index_deaths(e, host) : status;
}

static hk_status open_dying(emitter *e, const hk_host *host, double births) {
  size_t wanted = (size_t)((double)e->kept + births) + 1;
  if (wanted <= e->dying_room) return HK_OK;
  host->release(host, e->dying);
  e->dying = host->allocate(host, 2 * wanted * sizeof *e->dying);
  e->dying_room = e->dying ? 2 * wanted : 0;
  return e->dying ? HK_OK : host->fail(host, HK_NO_MEMORY, "no memory for the deaths of %zu particles", wanted);
}

static hk_status emit_birth(emitter *e, call *c, double at, uint64_t number) {
  double lifetime, age = c->view->t - at;
  hk_birth birth = draw_birth(e, c->view, age, number, &lifetime);
  bool dead = at + lifetime <= c->view->t;
  e->living++;
  if (dead) {
    note_death(e, c, at + lifetime);
    return c->population->add_aged(c->population, &birth, age, 0, NULL);
  }
  particle *p = particles(e) + e->kept++;
  double *soonest = &e->soonest[(p - (particle *)e->list.item) / BLOCK];
  *p = (particle){at + lifetime, UINT32_MAX}; /* until the births take effect */
  *soonest = fmin(*soonest, p->dies);
  return c->population->add_aged(c->population, &birth, age, INFINITY, &p->id);
}

static void leave_out(emitter *e, const hk_host *host, double at) {
  if (e->left_out++ == 0)
    host->warn(host, "its capacity of %lld particles is reached at t = %g s: while it is full it bears none",
               (long long)e->capacity, at);
}

/* At most `births`, for which there is room. */
static hk_status bear_all(emitter *e, call *c, double births) {
  const hk_host *host = c->view->host;
  hk_status status = HK_OK;
  for (double born = 0; status == HK_OK; born++) {
    double of_rate, of_burst = hk_flow_next_burst(&e->flow);
    status = hk_flow_next(&e->flow, host, e->borne, c->view->t, &of_rate);
    double at = fmin(of_rate, of_burst);
    if (status != HK_OK || !(at <= c->view->t)) break;
    if (born >= births)
      return host->fail(host, HK_BAD_PARAM, "rate_of_time: it gave another number when it was asked again for a time");
    uint64_t number = of_rate <= of_burst ? 2 * (uint64_t)e->borne++ : 2 * (uint64_t)e->flow.bursts++ + 1;
    for (; c->gone < c->deaths && e->dying[c->gone] <= at; c->gone++) e->living--;
    if (e->living < e->capacity)
      status = emit_birth(e, c, at, number);
    else
      leave_out(e, host, at);
  }
  e->living -= (int64_t)(c->deaths - c->gone);
  return status;
}

static hk_status emit(void *self, const hk_view *view, double h, hk_population *population) {
  emitter *e = self;
  double births;
  hk_status status = hk_flow_births(&e->flow, view->host, e->borne, view->t, &births);
  call c = {.view = view, .population = population, .crowded = (double)e->living + births > (double)e->capacity};
  (void)h;
  if (status == HK_OK) status = reserve(e, view->host, births);
  if (status == HK_OK && c.crowded) status = open_dying(e, view->host, births);
  if (status == HK_OK) status = take_dead(e, &c);
  return status == HK_OK ? bear_all(e, &c, births) : status;
}

static const hk_source source = {.size = sizeof(hk_source), .emit = emit, .flags = HK_AFTER_STEPS};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_SOURCE,
    .name = "emitter",
    .summary =
        "emits particles at a rate and in bursts, from points, lines, discs, spheres or triangles; they live for a "
        "time",
    .reference = "Reeves, Particle systems, ACM TOG 2, 1983; Steele, Lea and Flood, OOPSLA 2014 (random numbers)",
    .instance_size = sizeof(emitter),
    .params = params,
    .fields = fields,
    .create = create,
    .destroy = destroy,
    .topology = topology,
    .source = &source,
};
