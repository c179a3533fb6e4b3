/* Choices of the command line that replace those of the script: the integrator with its parameters, the solver, and the
 * plugins to omit and to add. The scene does not change; the choices belong to one run. */
#include "core/scene/scene/scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Converts a text for a parameter: "true" and "false" are booleans, a text that reads as a number is a number, any
 * other a string. */
static hk_value value_of(const hk_param *p, const char *text) {
  char *end;
  double number = strtod(text, &end);
  if (p->boolean && strcmp(text, "true") == 0) return (hk_value){.kind = HK_VALUE_BOOLEAN, .boolean = true};
  if (p->boolean && strcmp(text, "false") == 0) return (hk_value){.kind = HK_VALUE_BOOLEAN};
  if (!p->string && !p->choice && end != text && *end == 0)
    return (hk_value){.kind = HK_VALUE_NUMBER, .number = number};
  return (hk_value){.kind = HK_VALUE_STRING, .text = text};
}

static hk_status set_one(const hk_scene *scene, hk_plugin_spec *spec, char *setting, hk_error *error) {
  char *equals = strchr(setting, '=');
  if (!equals)
    return hk_error_set(error, HK_BAD_PARAM, "%s: '%s' is not parameter=value, as in %s:threads=1", spec->label,
                        setting, spec->label);
  *equals = 0;
  const hk_param *p = hk_scene_param(scene, spec, setting, error);
  if (!p) return HK_BAD_PARAM;
  hk_value value = value_of(p, equals + 1);
  return hk_spec_set(spec, p, &value, scene->particles.n, error);
}

/* "name:parameter=value,parameter=value" */
static hk_status make_spec(const hk_scene *scene, hk_kind kind, const char *choice, hk_plugin_spec **made,
                           hk_error *error) {
  char *text = hk_string_copy(choice), *settings = text ? strchr(text, ':') : NULL, *rest = NULL;
  if (!text) return hk_error_set(error, HK_NO_MEMORY, "no memory for the choice '%s'", choice);
  if (settings) *settings++ = 0;
  const hk_plugin *plugin;
  hk_status status = hk_registry_find(scene->registry, kind, text, scene->trusted, &plugin, error);
  if (status == HK_OK && !(*made = hk_spec_create(plugin, plugin->name, "", error))) status = HK_NO_MEMORY;
  for (char *one = settings ? strtok_r(settings, ",", &rest) : NULL; one && status == HK_OK;
       one = strtok_r(NULL, ",", &rest))
    status = set_one(scene, *made, one, error);
  if (status == HK_OK) status = hk_spec_check(*made, error);
  free(text);
  return status;
}

static bool is_default_method(const hk_plugin *plugin, const void *context) {
  (void)context;
  return !(plugin->integrator->flags & (HK_IMPLICIT | HK_ADAPTIVE));
}

static hk_status default_method(const hk_scene *scene, hk_plugin_spec **made, hk_error *error) {
  const hk_plugin *plugin;
  hk_status status = hk_registry_prefer(scene->registry, HK_INTEGRATOR, is_default_method, NULL, &plugin, error);
  if (status == HK_OK && !(*made = hk_spec_create(plugin, plugin->name, "", error))) status = HK_NO_MEMORY;
  return status;
}

static bool in_scene(const hk_scene *scene, const char *label) {
  for (int kind = 0; kind < HK_KINDS; kind++)
    for (size_t k = 0; k < scene->plugin[kind].count; k++)
      if (kind != HK_INTEGRATOR && kind != HK_SOLVER && strcmp(scene->plugin[kind].item[k]->label, label) == 0)
        return true;
  return false;
}

/* The labels that may be left out, ", " between them; as many as have room. */
static void list_labels(const hk_scene *scene, char *into, size_t size) {
  size_t length = 0;
  into[0] = 0;
  for (int kind = 0; kind < HK_KINDS; kind++)
    for (size_t k = 0; k < scene->plugin[kind].count; k++) {
      const char *label = scene->plugin[kind].item[k]->label;
      if (kind == HK_INTEGRATOR || kind == HK_SOLVER || length + strlen(label) + 3 > size) continue;
      length += (size_t)snprintf(into + length, size - length, "%s%s", length ? ", " : "", label);
    }
}

static hk_status choose_integrator(hk_overrides *o, const hk_scene *scene, const char *integrator, hk_error *error) {
  hk_status status = HK_OK;
  o->integrator = hk_scene_one(scene, HK_INTEGRATOR);
  if (!integrator && scene->integrator_auto)
    return hk_error_set(error, HK_BAD_PARAM,
                        "the scene's integrator is 'auto', which `hooke run` chooses: name one (--integrator NAME)");
  if (integrator)
    status = make_spec(scene, HK_INTEGRATOR, integrator, &o->own[0], error);
  else if (!o->integrator)
    status = default_method(scene, &o->own[0], error);
  if (o->own[0]) o->integrator = o->own[0];
  return status;
}

hk_status hk_overrides_open(hk_overrides *o, const hk_scene *scene, const char *integrator, const char *solver,
                            size_t without_count, const char *const *without, hk_error *error) {
  *o = (hk_overrides){.without_count = without_count, .without = without};
  for (size_t k = 0; k < without_count; k++) {
    if (!in_scene(scene, without[k])) {
      char labels[256];
      list_labels(scene, labels, sizeof labels);
      return hk_error_set(error, HK_BAD_PARAM, "there is nothing labelled '%s' to leave out; the scene has %s",
                          without[k], *labels ? labels : "no forces, constraints, correctors, sources or outputs");
    }
    for (size_t j = 0; j < k; j++)
      if (strcmp(without[j], without[k]) == 0)
        return hk_error_set(error, HK_BAD_PARAM,
                            "there is nothing labelled '%s' to leave out a second time: name it once", without[k]);
  }
  hk_status status = choose_integrator(o, scene, integrator, error);
  bool named = solver && strcmp(solver, "auto") != 0;
  o->solver = solver ? NULL : hk_scene_one(scene, HK_SOLVER);
  if (status == HK_OK && named) status = make_spec(scene, HK_SOLVER, solver, &o->own[1], error);
  if (o->own[1]) o->solver = o->own[1];
  return status;
}

/* Outputs, forces, ...: what a scene may have any number of. Integrator and solver have options of their own, and
 * services come when they are asked for. */
static bool kind_of(const char *choice, hk_kind *kind) {
  static const hk_kind kinds[] = {HK_FORCE, HK_CONSTRAINT, HK_CORRECTOR, HK_SOURCE, HK_OUTPUT};
  size_t length = strcspn(choice, ":");
  for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
    const char *name = hk_kind_name(kinds[k]);
    *kind = kinds[k];
    if (strlen(name) == length && strncmp(name, choice, length) == 0 && choice[length]) return true;
  }
  return false;
}

hk_status hk_overrides_add(hk_overrides *o, const hk_scene *scene, const char *choice, hk_error *error) {
  hk_kind kind;
  if (!kind_of(choice, &kind))
    return hk_error_set(error, HK_BAD_PARAM,
                        "--with: '%s' is not KIND:NAME or KIND:NAME:parameter=value,..., where KIND is force, "
                        "constraint, corrector, source or output",
                        choice);
  hk_plugin_spec **more = realloc(o->added, (o->added_count + 1) * sizeof *more), *spec = NULL;
  if (!more) return hk_error_set(error, HK_NO_MEMORY, "no memory for '%s'", choice);
  o->added = more;
  hk_status status = make_spec(scene, kind, strchr(choice, ':') + 1, &spec, error);
  if (spec) o->added[o->added_count++] = spec;
  return status;
}

void hk_overrides_close(hk_overrides *o) {
  for (size_t k = 0; k < o->added_count; k++) hk_spec_destroy(o->added[k]);
  free(o->added);
  hk_spec_destroy(o->own[0]);
  hk_spec_destroy(o->own[1]);
  *o = (hk_overrides){0};
}

bool hk_overrides_leave_out(const hk_overrides *o, const hk_plugin_spec *spec) {
  for (size_t k = 0; k < o->without_count; k++)
    if (strcmp(o->without[k], spec->label) == 0) return true;
  return false;
}
