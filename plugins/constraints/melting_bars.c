/* Rigid bars that are there as long as they are cold: |x_j - x_i| = L until the mean of a channel over both ends, a
 * temperature or an enthalpy, has come to `melts`; from the next step on there is no bar, and there never is again
 * (Terzopoulos, Platt, Fleischer 1989, Heating and melting deformable models, section 4, in the limit of springs whose
 * stiffness has no bound: nothing of a rigid bar can soften). A bar is gone, too, when its tension, the multiplier of
 * its equation at the start of a step, is above `breaking`. Of several such bars that with the largest tension in parts
 * of its limit breaks first, and what the others bear then is found anew, so that a chain breaks at one link. The
 * equation and its derivatives are in plugins/common/lengths. A bar does no work, so that its end takes and gives no
 * energy; when it ends is known to a step. Impulses of contact are no tension. */
#include "plugins/common/channels/find_channel.h"
#include "plugins/common/elements/breakage.h"
#include "plugins/common/lengths/lengths.h"

typedef struct melting_bars {
  hk_lengths solid; /* first member: those that are left */
  hk_lengths all;
  const char *name;
  const hk_channel *channel;
  double melts;
  hk_per_tuple breaking;
  double *gone;     /* of all: 0 or 1 */
  uint32_t *listed; /* of those that are left: their places in `all` */
  double *tension;  /* of those, N */
} melting_bars;

static const hk_param params[] = {
    {"edges", "", "pairs of particles to join", .edges = HK_AT(melting_bars, all.edges), .flags = HK_REQUIRED},
    {"length", "m", "length; left out: the initial distance", .per_tuple = HK_AT(melting_bars, all.length),
     .limits = HK_ABOVE(0), .flags = HK_OPTIONAL},
    {"channel", "", "that the bars follow, a temperature or an enthalpy", .string = HK_AT(melting_bars, name),
     .flags = HK_REQUIRED},
    {"melts", "", "the channel's value, mean of both ends, at which a bar is gone",
     .number = HK_AT(melting_bars, melts), .flags = HK_REQUIRED},
    {"breaking", "N", "tension above which a bar is gone; left out: never", .per_tuple = HK_AT(melting_bars, breaking),
     .limits = HK_ABOVE(0), .flags = HK_OPTIONAL, .list = "edges"},
    {0},
};

static const hk_field fields[] = {
    {"gone", .per_tuple = HK_AT(melting_bars, gone), .list = "edges", .width = 1},
    {0},
};

/* Marks what has molten; whether that is more than before. */
static bool melt(melting_bars *b, const hk_view *view) {
  const double *y = view->y + b->channel->offset * view->n;
  bool any = false;
  for (size_t e = 0; e < b->all.edges.count; e++) {
    const uint32_t *pair = hk_tuple(&b->all.edges, e);
    if (b->gone[e] > 0 || !((y[pair[0]] + y[pair[1]]) / 2 >= b->melts)) continue;
    b->gone[e] = 1;
    any = true;
  }
  return any;
}

/* Breaks the bar that is loaded most, if that is too much. */
static bool break_one(melting_bars *b) {
  double most = 1;
  size_t which = b->all.edges.count;
  for (size_t k = 0; b->breaking.count && k < b->solid.edges.count; k++) {
    double load = b->tension[k] / hk_tuple_value(&b->breaking, b->listed[k]);
    if (load > most) most = load, which = b->listed[k];
  }
  if (which == b->all.edges.count) return false;
  b->gone[which] = 1;
  return true;
}

static size_t count_left(const melting_bars *b) {
  size_t count = 0;
  for (size_t e = 0; e < b->all.edges.count; e++) count += !(b->gone[e] > 0);
  return count;
}

static void keep(melting_bars *b) {
  uint32_t *index = (uint32_t *)(uintptr_t)b->solid.edges.index; /* its own memory */
  size_t kept = 0;
  for (size_t e = 0; e < b->all.edges.count; e++) {
    if (b->gone[e] > 0) continue;
    for (int end = 0; end < 2; end++) index[2 * kept + (size_t)end] = hk_tuple(&b->all.edges, e)[end];
    b->solid.length.value[kept] = hk_tuple_value(&b->all.length, e);
    b->tension[kept] = 0;
    b->listed[kept++] = (uint32_t)e;
  }
  b->solid.edges.count = kept;
}

static void lost(const void *self, hk_lost_elements *out) {
  const melting_bars *b = self;
  *out = (hk_lost_elements){b->all.edges, b->gone, 1};
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  melting_bars *b = self;
  size_t n = b->all.edges.count + 2; /* two at least, so that the lengths are a list */
  hk_status status = hk_find_channel(host, view->model, b->name, "channel", 1, &b->channel);
  if (status == HK_OK)
    status = hk_lengths_start(&b->all, host, view,
                              "a bar of no length has no direction; move one of them, or give the bar a length");
  if (status != HK_OK) return status;
  b->solid.edges = (hk_tuples){0, 2, host->allocate(host, n * sizeof(uint32_t[2]))};
  b->solid.length = (hk_per_tuple){n, host->allocate(host, n * sizeof(double))};
  b->listed = host->allocate(host, n * sizeof *b->listed);
  b->tension = host->allocate(host, n * sizeof *b->tension);
  if (!b->solid.edges.index || !b->solid.length.value || !b->listed || !b->tension)
    return host->fail(host, HK_NO_MEMORY, "no memory for %zu bars", b->all.edges.count);
  melt(b, view);
  keep(b);
  return hk_breakage_enter(host, &(hk_breakable){lost, self});
}

static hk_status topology(void *self, const hk_view *view) {
  (void)view;
  keep(self);
  return HK_OK;
}

static hk_status update(void *self, const hk_view *view, bool *changed) {
  melting_bars *b = self;
  const bool molten = melt(b, view);
  *changed = molten || break_one(b) || count_left(b) != b->solid.edges.count; /* also by a checkpoint */
  if (*changed) keep(b);
  return HK_OK;
}

static double *loads(void *self) {
  const melting_bars *b = self;
  return b->breaking.count ? b->tension : NULL;
}

static const hk_constraint constraint = {.size = sizeof(hk_constraint),
                                         .count = hk_lengths_count,
                                         .pattern = hk_lengths_pattern,
                                         .value = hk_lengths_value,
                                         .jacobian = hk_lengths_jacobian,
                                         .curvature = hk_lengths_curvature,
                                         .update = update,
                                         .loads = loads,
                                         .joins = HK_AT(melting_bars, solid.edges)};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_CONSTRAINT,
    .name = "melting_bars",
    .summary =
        "rigid bars that are gone where a channel has come to a value, or that break, |x_j - x_i| = L until then",
    .reference = "Terzopoulos, Platt, Fleischer 1989, Heating and melting deformable models (from goop to glop); "
                 "equations as of bars",
    .instance_size = sizeof(melting_bars),
    .params = params,
    .fields = fields,
    .create = create,
    .topology = topology,
    .constraint = &constraint,
};
