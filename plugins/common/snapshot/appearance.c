#include "plugins/common/snapshot/appearance.h"

#include "plugins/common/stress/stress.h"

#include <stdio.h>
#include <string.h>

enum { LONGEST = 63 };

static const char *const paints[] = {"tension", "sheet_stress", "solid_stress", "none", "strain",
                                     "speed",   "group",        "age",          "mass"}; /* as hk_paint */
static const char *const paint_labels[] = {"tension N", "stress N/m", "stress Pa", "",       "strain %",
                                           "speed m/s", "",           "age s",     "mass kg"};
static const char *const sizes[] = {"same", "mass"}; /* as hk_sizes */
enum { PAINTS = sizeof paints / sizeof *paints, SIZES = sizeof sizes / sizeof *sizes };

/* The number of letters to change, insert or leave out to make b of a (Levenshtein's distance). */
static size_t distance(const char *a, const char *b) {
  size_t row[LONGEST + 1], n = strlen(b);
  for (size_t j = 0; j <= n; j++) row[j] = j;
  for (size_t i = 0; a[i]; i++) {
    size_t corner = row[0];
    row[0] = i + 1;
    for (size_t j = 0; j < n; j++) {
      size_t change = corner + (a[i] != b[j]), least = row[j] < row[j + 1] ? row[j] : row[j + 1];
      corner = row[j + 1];
      row[j + 1] = change < least + 1 ? change : least + 1;
    }
  }
  return row[n];
}

/* Keeps the nearer of `best` and `name`; names that share less than half their letters are not meant. */
static void compare(const char *wanted, const char *name, const char **best, size_t *least) {
  size_t longer = strlen(wanted) > strlen(name) ? strlen(wanted) : strlen(name);
  if (longer > LONGEST) return;
  size_t here = distance(wanted, name);
  if (2 * here <= longer && here < *least) *best = name, *least = here;
}

static void append(char *list, size_t size, const char *name) {
  size_t at = strlen(list);
  snprintf(list + at, size - at, "%s%s", at ? ", " : "", name);
}

/* The error of a name that is neither among `known` nor a channel. */
static hk_status unknown(const hk_host *host, const hk_model *m, const char *param, const char *wanted,
                         const char *const known[], size_t count) {
  char list[512] = "";
  const char *near = NULL;
  size_t least = SIZE_MAX;
  for (size_t k = 0; k < count + m->channels; k++) {
    const char *name = k < count ? known[k] : m->channel[k - count].name;
    append(list, sizeof list, name);
    compare(wanted, name, &near, &least);
  }
  if (!*list) return host->fail(host, HK_BAD_PARAM, "%s: '%s': the scene has no channels", param, wanted);
  return host->fail(host, HK_BAD_PARAM, "%s: '%s' is not one of %s%s%s%s", param, wanted, list,
                    near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
}

/* The position of the channel, or the number of channels. */
static size_t find_channel(const hk_model *m, const char *name) {
  size_t k = 0;
  while (k < m->channels && strcmp(m->channel[k].name, name) != 0) k++;
  return k;
}

/* The position in the list, or its length. */
static size_t find_name(const char *const list[], size_t count, const char *name) {
  size_t k = 0;
  while (k < count && strcmp(list[k], name) != 0) k++;
  return k;
}

/* Strain is shown of plain edges. */
static bool has_strain(const hk_model *m) {
  bool any = false;
  for (size_t k = 0; k < m->element_lists; k++) any |= hk_elements_are_edges(&m->element_list[k].elements);
  return any;
}

/* The scene has to have what the colours are of; "stress" is of what it has. */
static hk_status choose_stress(const hk_host *host, const hk_model *m, const char **color) {
  static const char *const what[HK_STRESS_KINDS] = {"springs, bars or cables", "sheets", "solids"};
  bool sheets = hk_stress_any(m, HK_SHEET_STRESS), solids = hk_stress_any(m, HK_SOLID_STRESS);
  if (strcmp(*color, "stress") == 0) {
    if (sheets && solids)
      return host->fail(host, HK_BAD_PARAM,
                        "color: the scene has sheets, whose stress is in N/m, and solids, of Pa: "
                        "say sheet_stress or solid_stress");
    if (!sheets && !solids)
      return host->fail(host, HK_BAD_PARAM,
                        "color: no force of the scene is one of sheets or solids that tells its "
                        "stress; springs and bars have tension");
    *color = sheets ? hk_stress_names[HK_SHEET_STRESS] : hk_stress_names[HK_SOLID_STRESS];
  }
  size_t kind = find_name(hk_stress_names, HK_STRESS_KINDS, *color);
  if (kind == HK_STRESS_KINDS || hk_stress_any(m, (hk_stress_kind)kind)) return HK_OK;
  return host->fail(host, HK_BAD_PARAM, "color: '%s' is that of %s, and the scene has none that tell it", *color,
                    what[kind]);
}

static hk_status choose_paint(hk_appearance *appearance, const hk_host *host, const hk_model *m, bool whole,
                              const char *color, const char **label) {
  static const char *const known[] = {"auto",         "none",  "strain", "tension", "stress", "sheet_stress",
                                      "solid_stress", "speed", "group",  "age",     "mass"};
  bool chosen = strcmp(color, "auto") == 0;
  if (chosen) color = has_strain(m) ? "strain" : m->triangles.count ? "none" : "speed";
  size_t channel = chosen ? m->channels : find_channel(m, color);
  hk_status status = whole && channel == m->channels ? choose_stress(host, m, &color) : HK_OK;
  if (status != HK_OK) return status;
  if (strcmp(color, "stress") == 0) color = hk_stress_names[HK_SOLID_STRESS]; /* until elements are known */
  size_t paint = find_name(paints, PAINTS, color);
  if (channel < m->channels) {
    appearance->paint = m->channel[channel].size == 3 ? HK_PAINT_RGB : HK_PAINT_CHANNEL;
    appearance->channel = channel;
    *label = m->channel[channel].name;
    return HK_OK;
  }
  if (paint == PAINTS) return unknown(host, m, "color", color, known, sizeof known / sizeof *known);
  appearance->paint = (hk_paint)paint;
  *label = paint_labels[paint];
  return HK_OK;
}

/* A channel that has one number per particle. */
static hk_status check_number(const hk_host *host, const hk_model *m, const char *param, size_t channel) {
  const hk_channel *c = m->channel + channel;
  if (c->size == 1) return HK_OK;
  return host->fail(host, HK_BAD_PARAM, "%s: the channel '%s' has %zu numbers per particle; one is needed", param,
                    c->name, c->size);
}

static hk_status choose_sizes(hk_appearance *appearance, const hk_host *host, const hk_model *m, const char *size) {
  static const char *const known[] = {"auto", "same", "mass"};
  bool chosen = strcmp(size, "auto") == 0;
  size_t channel = find_channel(m, chosen ? "radius" : size);
  if (chosen && (channel == m->channels || m->channel[channel].size != 1)) size = "same", channel = m->channels;
  size_t kind = find_name(sizes, SIZES, size);
  appearance->size_channel = channel;
  appearance->sizes = channel < m->channels ? HK_SIZE_CHANNEL : (hk_sizes)kind;
  if (channel < m->channels) return check_number(host, m, "size", channel);
  return kind < SIZES ? HK_OK : unknown(host, m, "size", size, known, sizeof known / sizeof *known);
}

static hk_status choose_fade(hk_appearance *appearance, const hk_host *host, const hk_model *m, const char *fade) {
  appearance->fades = fade != NULL;
  if (!fade) return HK_OK;
  appearance->fade_channel = find_channel(m, fade);
  if (appearance->fade_channel == m->channels) return unknown(host, m, "fade", fade, NULL, 0);
  return check_number(host, m, "fade", appearance->fade_channel);
}

/* Reads "GROUP RADIUS" up to a comma or the end, and moves on behind it. */
static hk_status read_tube(hk_appearance *appearance, const hk_host *host, const hk_model *m, const char **at) {
  char name[64];
  int used = 0;
  double radius;
  uint32_t group = 0;
  if (sscanf(*at, " %63[^, ] %lf %n", name, &radius, &used) < 2 || !(radius > 0) || !strchr(",", (*at)[used]))
    return host->fail(host, HK_BAD_PARAM,
                      "tubes: expected a channel, or groups with radii above 0, \"rope 0.01, thread 0.002\"");
  while (group < m->groups && strcmp(m->group_name[group], name) != 0) group++;
  if (group == m->groups) return host->fail(host, HK_BAD_PARAM, "tubes: there is no group '%s'", name);
  if (appearance->tube_groups == HK_TUBE_GROUPS)
    return host->fail(host, HK_BAD_PARAM, "tubes: radii of %d groups at most; a channel has one for each particle",
                      HK_TUBE_GROUPS);
  appearance->tube_group[appearance->tube_groups].group = group;
  appearance->tube_group[appearance->tube_groups++].radius = radius;
  *at += used + ((*at)[used] == ',');
  return HK_OK;
}

static hk_status choose_tubes(hk_appearance *appearance, const hk_host *host, const hk_model *m, const char *tubes) {
  appearance->radii = tubes ? (hk_strand_radii){0} : hk_strand_radii_find(host, m);
  appearance->tube_groups = 0;
  appearance->tubes = tubes ? *tubes : hk_strand_radii_any(&appearance->radii);
  if (!tubes || !*tubes) return HK_OK;
  appearance->tube_channel = find_channel(m, tubes);
  if (appearance->tube_channel < m->channels) return check_number(host, m, "tubes", appearance->tube_channel);
  if (!strchr(tubes, ' ')) return unknown(host, m, "tubes", tubes, NULL, 0);
  hk_status status = HK_OK;
  while (*tubes && status == HK_OK) status = read_tube(appearance, host, m, &tubes);
  return status;
}

hk_status hk_appearance_choose(hk_appearance *appearance, const hk_host *host, const hk_model *m, bool whole,
                               const hk_appearance_names *names, const char **label) {
  hk_status status = choose_paint(appearance, host, m, whole, names->color, label);
  if (status == HK_OK) status = choose_sizes(appearance, host, m, names->size);
  if (status == HK_OK) status = choose_tubes(appearance, host, m, names->tubes);
  return status == HK_OK ? choose_fade(appearance, host, m, names->fade) : status;
}
