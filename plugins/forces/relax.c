/* A channel that approaches a value, and one that grows: with u = y - target,
 *     dy/dt = growth - rate u |u/scale|^(power - 1)
 * for each number of the channel alone. Power 1 is an exponential approach: Newton's law of cooling, a colour that
 * fades; power 4 the cooling of flames by radiation that is usual in graphics (Nguyen, Fedkiw and Jensen, Physically
 * based modeling and animation of fire, SIGGRAPH 2002), scale being the largest difference. Without growth u =
 * u0 exp(-rate t), or (|u0|^(1-p) + (p - 1) rate scale^(1-p) t)^(1/(1-p)) with the sign of u0. It is no force: it adds
 * nothing to F. */
#include "plugins/common/channels/find_channel.h"
#include "plugins/common/channels/no_force.h"

typedef struct relax {
  const char *name;
  double rate, power, scale, growth;
  hk_numbers target;
  const hk_channel *channel;
} relax;

static const hk_param params[] = {
    {"channel", "", "the channel that changes", .string = HK_AT(relax, name), .flags = HK_REQUIRED},
    {"rate", "1/s", "at which the channel approaches its target", .number = HK_AT(relax, rate),
     .limits = HK_AT_LEAST(0), .flags = HK_TIMED},
    {"target", "", "what it approaches: one number, or one for each of the channel's; left out: 0",
     .numbers = HK_AT(relax, target), .flags = HK_OPTIONAL},
    {"power", "", "of the difference: 1, exponential; 4, as by radiation", .number = HK_AT(relax, power),
     .initial = {1}, .limits = HK_WITHIN(1, 16)},
    {"scale", "", "the difference for which `rate` is meant, where power is not 1", .number = HK_AT(relax, scale),
     .initial = {1}, .limits = HK_ABOVE(0)},
    {"growth", "1/s", "what is added to each number per second", .number = HK_AT(relax, growth), .flags = HK_TIMED},
    {0},
};

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  relax *r = self;
  hk_status status = hk_find_channel(host, view->model, r->name, "channel", 0, &r->channel);
  if (status != HK_OK) return status;
  if (r->target.count > 1 && r->target.count != r->channel->size)
    return host->fail(host, HK_BAD_PARAM, "target: %zu numbers for the channel '%s', which has %zu", r->target.count,
                      r->name, r->channel->size);
  return HK_OK;
}

typedef struct task {
  const relax *self;
  const hk_view *view;
  double *dy;
} task;

static double target_of(const relax *r, size_t c) {
  return r->target.count == 0 ? 0 : r->target.value[r->target.count > 1 ? c : 0];
}

/* |u/scale|^(power - 1); whole powers without pow(), which would be most of the time of a step. */
static double slowing(const relax *r, double u) {
  double part = fabs(u) / r->scale, product = 1;
  if (r->power != floor(r->power)) return pow(part, r->power - 1);
  for (double k = 1; k < r->power; k++) product *= part;
  return product;
}

static void rate_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  const relax *r = t->self;
  size_t size = r->channel->size, first = r->channel->offset * t->view->n;
  (void)chunk;
  for (size_t k = begin; k < end; k++) {
    size_t at = first + size * (t->view->active ? t->view->active[k] : k);
    for (size_t c = 0; c < size; c++) {
      double u = t->view->y[at + c] - target_of(r, c);
      t->dy[at + c] += r->growth - r->rate * u * slowing(r, u);
    }
  }
}

static hk_status rates(void *self, const hk_view *view, double *dy) {
  task t = {self, view, dy};
  view->host->parallel_for(view->host, view->acting, 4096, rate_chunk, &t);
  return HK_OK;
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_CHANNELS | HK_SYMMETRIC_JACOBIAN,
    .add = hk_no_force,
    .energy = hk_no_energy,
    .rates = rates,
    .facets = HK_FACETS(HK_NO_BLOCKS),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "relax",
    .summary = "a channel cools, fades or grows: dy/dt = growth - rate u |u/scale|^(power - 1), u = y - target",
    .reference = "Newton's law of cooling; Nguyen, Fedkiw and Jensen, SIGGRAPH 2002",
    .instance_size = sizeof(relax),
    .params = params,
    .create = create,
    .force = &force,
};
