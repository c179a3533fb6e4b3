/* What the command line changes in a scene before it runs: the integrator with its parameters, the solver, and what is
 * left out. */
#include "core/run/engine.h"
#include "core/base/memory.h"

#include <stdlib.h>
#include <string.h>

/* ---- "name:parameter=value,parameter=value" ---- */

/* A text as the parameter wants it: true and false are booleans, what reads as a number is one, the rest is text. */
static hk_value value_of(const hk_param *p, const char *text) {
  char *end;
  double number = strtod(text, &end);
  if (p->type == HK_BOOLEAN && strcmp(text, "true") == 0) return (hk_value){.kind = HK_VALUE_BOOLEAN, .boolean = true};
  if (p->type == HK_BOOLEAN && strcmp(text, "false") == 0) return (hk_value){.kind = HK_VALUE_BOOLEAN};
  if (p->type != HK_STRING && p->type != HK_CHOICE && end != text && *end == 0)
    return (hk_value){.kind = HK_VALUE_NUMBER, .number = number};
  return (hk_value){.kind = HK_VALUE_STRING, .text = text};
}

static hk_status set_one(hk_run *run, hk_instance *instance, char *setting) {
  char *equals = strchr(setting, '=');
  if (!equals)
    return hk_error_set(&run->error, HK_BAD_PARAM, "%s: '%s' is not parameter=value, as in xpbd:substeps=10,bdf=2",
                        instance->label, setting);
  *equals = 0;
  const hk_param *p = hk_instance_param(instance, setting, &run->error);
  if (!p) return HK_BAD_PARAM;
  hk_value value = value_of(p, equals + 1);
  return hk_instance_set(instance, p, &value, run->scene->n, &run->error);
}

static hk_status add_with_settings(hk_run *run, hk_kind kind, const char *choice) {
  char *text = hk_string_copy(choice), *settings = text ? strchr(text, ':') : NULL, *rest = NULL;
  hk_instance *instance;
  if (!text) return hk_error_set(&run->error, HK_NO_MEMORY, "no memory for the choice '%s'", choice);
  if (settings) *settings++ = 0;
  hk_status status = hk_scene_add_plugin(run->scene, kind, text, NULL, "", &instance, &run->error);
  for (char *one = settings ? strtok_r(settings, ",", &rest) : NULL; one && status == HK_OK;
       one = strtok_r(NULL, ",", &rest))
    status = set_one(run, instance, one);
  if (status == HK_OK) status = hk_instance_check(instance, &run->error);
  free(text);
  return status;
}

/* ---- what is left out ---- */

static bool drop_from(hk_scene *scene, const hk_instances *list, const char *label) {
  for (size_t k = 0; k < list->count; k++)
    if (strcmp(list->item[k]->label, label) == 0) {
      hk_scene_drop(scene, list->item[k]);
      return true;
    }
  return false;
}

static hk_status leave_out(hk_run *run, const char *label) {
  hk_scene *scene = run->scene;
  const hk_instances *lists[] = {&scene->force, &scene->constraint, &scene->corrector, &scene->source, &scene->output};
  for (size_t k = 0; k < sizeof lists / sizeof *lists; k++)
    if (drop_from(scene, lists[k], label)) return HK_OK;
  return hk_error_set(&run->error, HK_BAD_PARAM, "there is nothing labelled '%s' to leave out", label);
}

/* ---- all of it ---- */

hk_status hk_overrides_apply(hk_run *run) {
  hk_scene *scene = run->scene;
  const hk_run_options *o = &run->options;
  hk_status status = HK_OK;
  for (size_t k = 0; k < o->without_count && status == HK_OK; k++) status = leave_out(run, o->without[k]);
  if (status == HK_OK && !o->integrator && scene->integrator_auto)
    return hk_error_set(&run->error, HK_BAD_PARAM,
                        "the scene's integrator is 'auto', which `hooke run` chooses: name one (--integrator NAME)");
  if (status == HK_OK && (o->integrator || !scene->integrator))
    status = add_with_settings(run, HK_INTEGRATOR, o->integrator ? o->integrator : "leapfrog");
  if (status == HK_OK && o->solver && scene->solver) hk_scene_drop(scene, scene->solver);
  if (status == HK_OK && o->solver && strcmp(o->solver, "auto") != 0)
    status = add_with_settings(run, HK_SOLVER, o->solver);
  if (status != HK_OK) return status;
  run->method = scene->integrator->plugin->integrator;
  if (scene->constraint.count && run->method->flags & HK_IMPLICIT)
    return hk_error_set(&run->error, HK_BAD_PARAM,
                        "%s takes no constraints ('%s'): choose an explicit integrator, or stiff springs instead",
                        scene->integrator->plugin->name, scene->constraint.item[0]->label);
  run->system.host = &scene->integrator->host;
  run->system.tol = isnan(o->tol) ? scene->tol : o->tol;
  return HK_OK;
}
