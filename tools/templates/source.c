/* NAME: a nozzle that emits particles at a rate; each lives for a time. Describe here what it adds and removes. */
#include "core/plugin.h"

typedef struct NAME {
  double position[3], velocity[3];   /* m, m/s */
  double mass, interval, life, next; /* kg, s */
  double *age;                       /* n, s; negative: not of this source */
} NAME;

static const hk_param params[] = {
    {"position", "m", "of the nozzle", .vector = HK_AT(NAME, position)},
    {"velocity", "m/s", "of a new particle", .vector = HK_AT(NAME, velocity), .initial = {0, 0, 1}},
    {"mass", "kg", "of a new particle", .number = HK_AT(NAME, mass), .initial = {1}, .limits = HK_ABOVE(0)},
    {"interval", "s", "between two particles", .number = HK_AT(NAME, interval), .initial = {0.1},
     .limits = HK_ABOVE(0)},
    {"life", "s", "of a particle", .number = HK_AT(NAME, life), .initial = {1e9}, .limits = HK_ABOVE(0)},
    {0},
};

/* What evolves: checkpoints save it, and the host moves the ages when particles die; those of new ones are 0. */
static const hk_field fields[] = {
    {"next", .number = HK_AT(NAME, next)},
    {"age", .per_particle = HK_AT(NAME, age), .width = 1},
    {0},
};

/* The particles of the start are not of this source. */
static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  NAME *p = self;
  (void)host;
  for (size_t i = 0; i < view->n; i++) p->age[i] = -INFINITY;
  return HK_OK;
}

/* Called before a step of h s. Births and deaths take effect together when it returns. */
static hk_status emit(void *self, const hk_view *view, double h, hk_population *population) {
  NAME *p = self;
  hk_birth birth = {.mass = p->mass};
  hk_status status = HK_OK;
  for (size_t i = 0; i < view->n && status == HK_OK; i++)
    if (p->age[i] >= p->life)
      status = population->remove(population, (uint32_t)i);
    else
      p->age[i] += h;
  for (; p->next <= view->t && status == HK_OK; p->next += p->interval) {
    double late = view->t - p->next; /* it has left the nozzle since */
    for (int c = 0; c < 3; c++) {
      birth.velocity[c] = p->velocity[c];
      birth.position[c] = p->position[c] + late * p->velocity[c];
    }
    status = population->add(population, &birth, NULL);
  }
  return status;
}

static const hk_source source = {.size = sizeof(hk_source), .emit = emit};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_SOURCE,
    .name = "NAME",
    .summary = "a nozzle that emits a particle every so many seconds, which lives for a time",
    .reference = "",
    .instance_size = sizeof(NAME),
    .params = params,
    .fields = fields,
    .create = create,
    .source = &source,
};
