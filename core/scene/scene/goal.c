/* What `hooke optimise` looks for: controls, functions of time whose values at knots are free, with which measures have
 * given values at given times. A run takes no notice of goals. */
#include "core/engine/base/base.h"
#include "core/engine/text/text.h"
#include "core/scene/scene/scene.h"

#include <stdlib.h>
#include <string.h>

/* Beyond bounds by this part of the largest value is within them: differences by a control move all of it by less. Of
 * one that is 0 they take the part of 1 (tools/common/gradient/derivative.lua), and what they move is no larger than
 * this. */
static const double margin = 1e-5;

static double largest(const hk_control *c) {
  double most = 0;
  for (size_t k = 0; k < c->knots; k++) most = fmax(most, fabs(c->value[k]));
  return most;
}

static hk_status check_control(const hk_scene *scene, const hk_control *c, hk_error *error) {
  for (size_t k = 0; k < scene->controls; k++)
    if (strcmp(scene->control[k].name, c->name) == 0)
      return hk_error_set(error, HK_BAD_PARAM, "control '%s': there is already one of this name", c->name);
  if (!(c->min < c->max))
    return hk_error_set(error, HK_BAD_PARAM, "control '%s': min: %g is not below max, %g", c->name, c->min, c->max);
  double most = largest(c), beyond = margin * (most > margin ? most : 1);
  for (size_t k = 0; k < c->knots; k++) {
    bool above = c->value[k] > c->max + beyond;
    if (above || c->value[k] < c->min - beyond)
      return hk_error_set(error, HK_BAD_PARAM,
                          "control '%s': the value %g at knot %zu is %s, %g: give others, or wider bounds", c->name,
                          c->value[k], k + 1, above ? "above max" : "below min", above ? c->max : c->min);
  }
  return HK_OK;
}

hk_status hk_scene_add_control(hk_scene *scene, const hk_control *c, hk_error *error) {
  hk_status status = check_control(scene, c, error);
  if (status != HK_OK) return status;
  hk_control *grown = realloc(scene->control, (scene->controls + 1) * sizeof *grown), made = *c;
  if (grown) scene->control = grown;
  made.name = hk_string_copy(c->name);
  made.value = malloc(c->knots * sizeof *made.value);
  if (!grown || !made.name || !made.value) {
    free(made.name);
    free(made.value);
    return hk_error_set(error, HK_NO_MEMORY, "no memory for the control '%s'", c->name);
  }
  memcpy(made.value, c->value, c->knots * sizeof *made.value);
  scene->control[scene->controls++] = made;
  return HK_OK;
}

static const char *measure_name(const void *context, size_t k) {
  const hk_scene *scene = context;
  return k < scene->measures ? scene->measure[k].name : NULL;
}

static hk_status no_measure(const hk_scene *scene, const char *name, hk_error *error) {
  const char *near = hk_nearest_name(name, measure_name, scene);
  if (near) return hk_error_set(error, HK_BAD_PARAM, "goal: there is no measure '%s'; did you mean '%s'?", name, near);
  return hk_error_set(error, HK_BAD_PARAM, "goal: there is no measure '%s' before this line: scene:measure(\"%s\", f)",
                      name, name);
}

static hk_status refuse_second(const char *measure, const hk_goal *goal, const hk_goal *other, hk_error *error) {
  const char *colon = strrchr(other->where, ':'), *line = colon ? colon + 1 : "not known";
  if (goal->low == goal->high && other->low == other->high)
    return hk_error_set(error, HK_BAD_PARAM,
                        "goal: %s at %g s is %g already (line %s), and cannot be %g: leave one out", measure, goal->at,
                        other->low, line, goal->low);
  return hk_error_set(error, HK_BAD_PARAM,
                      "goal: %s at %g s has a goal already (line %s): give a value, or min and max together", measure,
                      goal->at, line);
}

hk_status hk_scene_add_goal(hk_scene *scene, const char *measure, const hk_goal *wanted, const char *where,
                            hk_error *error) {
  hk_goal goal = *wanted;
  double at = goal.at;
  goal.measure = 0;
  while (goal.measure < scene->measures && strcmp(scene->measure[goal.measure].name, measure) != 0) goal.measure++;
  if (goal.measure == scene->measures) return no_measure(scene, measure, error);
  if (!(at > 0 && at <= scene->duration))
    return hk_error_set(error, HK_BAD_PARAM, "goal: at: %g s is not within the run, above 0 and up to its end at %g s",
                        at, scene->duration);
  if (!(goal.low <= goal.high))
    return hk_error_set(error, HK_BAD_PARAM, "goal: min: %g is above max, %g: no value of %s lies between", goal.low,
                        goal.high, measure);
  for (size_t k = 0; k < scene->goals; k++) {
    const hk_goal *other = &scene->goal[k];
    if (other->measure == goal.measure && other->at == at) return refuse_second(measure, &goal, other, error);
  }
  hk_goal *grown = realloc(scene->goal, (scene->goals + 1) * sizeof *grown);
  if (grown) scene->goal = grown;
  goal.where = hk_string_copy(where);
  if (!grown || !goal.where) {
    free(goal.where);
    return hk_error_set(error, HK_NO_MEMORY, "no memory for a goal");
  }
  scene->goal[scene->goals++] = goal;
  return HK_OK;
}
