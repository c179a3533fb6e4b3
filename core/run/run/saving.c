/* Checkpoints of a run under way, for outputs ("checkpoint/1"). The run can go on bit by bit from a point where all
 * that its methods know is in saved fields. For explicit methods that is between any two steps, where nothing rests on
 * one-sided constraints. Methods that solve
 * linear systems keep factors, and some a library's history: at the frames that an output asks for they are made to do
 * without, so that the run that stops there and the one that does not go on alike. Such a point is kept in memory until
 * the next, so that a run which ends in between has it. */
#include "core/numerics/implicit/implicit.h"
#include "core/run/run/run.h"

#include <stdlib.h>
#include <string.h>

static hk_status ask(void *self, const char *path) {
  hk_run *run = self;
  hk_saving *s = &run->saving;
  if (path && strlen(path) >= sizeof s->path)
    return hk_error_set(&run->error, HK_IO, "the path %.200s... of a checkpoint is too long", path);
  s->asked = true;
  strcpy(s->path, path ? path : "");
  return HK_OK;
}

/* The scene's lines, and those of the plugins, of which the files are hashed. */
static hk_status find_origin(hk_run *run) {
  hk_saving *s = &run->saving;
  char name[256];
  const hk_registry *registry = run->scene->registry;
  bool fine = s->origin || !run->scene->origin || (s->origin = hk_string_copy(run->scene->origin));
  for (int kind = 0; kind < HK_KINDS; kind++)
    for (size_t k = 0; k < run->plugins.kind[kind].count && fine && kind != HK_OUTPUT; k++) {
      const hk_instance *instance = run->plugins.kind[kind].item[k];
      snprintf(name, sizeof name, "the %s '%s' of the plugin %s", hk_kind_name((hk_kind)kind), instance->label,
               instance->plugin->name);
      for (size_t r = 0; r < registry->count && fine; r++)
        if (registry->item[r].plugin == instance->plugin)
          fine = hk_origin_add_file(&s->origin, name, registry->item[r].path);
    }
  if (fine && !s->origin) fine = hk_origin_add(&s->origin, "the plugins", "none");
  return fine ? HK_OK : hk_error_set(&run->error, HK_NO_MEMORY, "no memory for a checkpoint");
}

/* The factors of constraints follow from (x, t): they are made anew here as by a run that goes on from the point, so
 * that both count the same. So are the patterns of systems of other plugins, as a solver may analyse the values too. */
static hk_status take(hk_run *run, hk_checkpoint *point) {
  hk_constraints_forget(&run->dynamics);
  hk_asked_solvers_forget(&run->dynamics);
  return hk_checkpoint_take(point, &run->loop, &run->judgement, run->saving.origin, run->options.words, &run->error);
}

static hk_status write_to(hk_run *run, const char *path) {
  double begin = hk_clock();
  hk_status status = hk_checkpoint_write(&run->saving.point, path, &run->error);
  run->saving.on_file = status == HK_OK;
  run->loop.output_seconds += hk_clock() - begin;
  return status;
}

/* Whether the method keeps data between steps that checkpoints do not hold. */
static bool hides(const hk_run *run) {
  return run->loop.method->flags & (HK_IMPLICIT | HK_NEEDS_JACOBIAN | HK_NEEDS_SOLVER);
}

/* Drops those data. A method without `reset` has none, or does not know of this. */
static void renew(hk_run *run) {
  hk_step_reset(&run->loop, HK_CHECKPOINT);
  if (run->loop.method->reset) hk_jacobian_topology(&run->dynamics);
}

hk_status hk_run_framed(void *context) {
  hk_run *run = context;
  hk_saving *s = &run->saving;
  if (!s->asked) return HK_OK;
  s->asked = false;
  if (hides(run)) renew(run);
  hk_status status = take(run, &s->point);
  s->on_file = false;
  return status == HK_OK && *s->path ? write_to(run, s->path) : status;
}

/* Whether a one-sided equation pushes that steps are cut for where it lets go (release.c): where that is follows from
 * the step before, too. */
static bool may_let_go(const hk_run *run) {
  const hk_constraints *c = run->dynamics.constraints;
  bool any = false;
  if (!c || hk_constraint_order(&run->dynamics) <= HK_RELEASE_MATTERS) return false;
  for (size_t k = 0; k < c->equations; k++) any |= c->one_sided[k] && c->releases.acts[k];
  return any;
}

/* Whether the present state, between two steps, will do. */
static bool anywhere(const hk_run *run) { return run->loop.between_steps && !hides(run) && !may_let_go(run); }

static hk_status newest(void *self, bool *newer) {
  hk_run *run = self;
  hk_saving *s = &run->saving;
  hk_status status = HK_OK;
  if (anywhere(run)) {
    status = take(run, &s->point);
    s->on_file = false;
  }
  *newer = status == HK_OK && s->point.count > 0 && !s->on_file;
  return status;
}

/* At any time: what the methods hide is not renewed, so that a run with factors goes on to its tolerance only. */
hk_status hk_run_save(hk_run *run, const char *path, hk_error *error) {
  hk_checkpoint c = {0};
  hk_saving *s = &run->saving;
  hk_status status = s->origin ? HK_OK : find_origin(run);
  if (status == HK_OK) status = take(run, &c);
  if (status == HK_OK) status = hk_checkpoint_write(&c, path, &run->error);
  hk_checkpoint_free(&c);
  return status == HK_OK ? status : hk_error_set(error, status, "%s", run->error.text);
}

static hk_status write_newest(void *self, const char *path) { return write_to(self, path); }

hk_status hk_run_begin_saving(hk_run *run) {
  bool needed = run->saving.served || run->options.resume;
  return needed ? find_origin(run) : HK_OK;
}

const void *hk_run_checkpoints(hk_run *run) {
  hk_saving *s = &run->saving;
  s->served = true;
  s->table = (hk_checkpoints){run, ask, newest, write_newest};
  return &s->table;
}

void hk_run_end_saving(hk_run *run) {
  hk_checkpoint_free(&run->saving.point);
  free(run->saving.origin);
}
