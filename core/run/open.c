/* Opening a run. Each part is built after the parts that it needs: state, pins, instances of the plugins, dynamics,
 * solver, constraints, the start state, the step size, the outputs. When one of them fails, hk_run_destroy frees those
 * that exist; it therefore accepts a partly built run. */
#include "core/run/run.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { RUN_FRAMES = 25 }; /* a run takes some 800 bytes a particle, a frame 32 */
static const double golden = 0.61803398874989485;

/* ---- services that plugins ask for ---- */

static hk_status path_of(void *context, const char *name, char *buffer, size_t size) {
  hk_run *run = context;
  return hk_folder_path(run->folder, name, buffer, size, &run->error);
}

static bool serves(const hk_plugin *plugin, const char *wanted) {
  return plugin->service->interface && strcmp(plugin->service->interface, wanted) == 0;
}

/* With the parameters that the scene gave; NULL: it names none of that interface. */
static const hk_plugin_spec *named_service(const hk_run *run, const char *wanted) {
  const hk_specs *named = &run->scene->plugin[HK_SERVICE];
  for (size_t k = 0; k < named->count; k++)
    if (serves(named->item[k]->plugin, wanted)) return named->item[k];
  return NULL;
}

static const void *table_of(const hk_instance *service) {
  const hk_service *functions = service->plugin->service;
  const hk_instance *outer = hk_enter(service);
  const void *table = functions->table ? functions->table(service->self) : NULL;
  hk_leave(service, outer);
  return table;
}

static const hk_plugin_spec *found_service(hk_run *run, const char *wanted) {
  char name[64];
  const hk_plugin *plugin;
  hk_error why = {0};
  snprintf(name, sizeof name, "%.*s", (int)strcspn(wanted, "/"), wanted);
  hk_status status = hk_registry_find(run->scene->registry, HK_SERVICE, name, false, &plugin, &why);
  if (status == HK_FAILED) hk_error_set(&run->error, status, "%s", why.text); /* it is there and cannot be used */
  if (status != HK_OK || !serves(plugin, wanted)) return NULL;
  hk_plugin_spec **grown = realloc(run->service_spec, (run->services + 1) * sizeof *grown);
  if (grown) run->service_spec = grown;
  hk_plugin_spec *spec = grown ? hk_spec_create(plugin, plugin->name, "", &run->error) : NULL;
  if (spec) run->service_spec[run->services++] = spec;
  return spec;
}

/* Each service has one instance per run, which is created and started at the first request. */
static const void *query(void *context, const char *wanted) {
  hk_run *run = context;
  if (strcmp(wanted, "checkpoint/1") == 0) return hk_run_checkpoints(run);
  if (strcmp(wanted, "interruption/1") == 0) return &run->interruption;
  if (strcmp(wanted, "draft/1") == 0) return &run->options.draft;
  const hk_instances *services = &run->plugins.kind[HK_SERVICE];
  for (size_t k = 0; k < services->count; k++)
    if (serves(services->item[k]->plugin, wanted)) return table_of(services->item[k]);
  const hk_plugin_spec *spec = named_service(run, wanted);
  if (!spec) spec = found_service(run, wanted);
  hk_instance *service = NULL;
  if (!spec || hk_plugins_add(&run->plugins, spec, &run->shared, &service, &run->error) != HK_OK) return NULL;
  hk_view view = hk_instance_view(service, &run->state.view);
  if (hk_instance_start(service, &view, run->state.size, &run->error) != HK_OK) return NULL;
  return table_of(service);
}

static void warn_of_unused_services(hk_run *run) {
  const hk_specs *named = &run->scene->plugin[HK_SERVICE];
  const hk_instances *used = &run->plugins.kind[HK_SERVICE];
  for (size_t k = 0; k < named->count; k++) {
    bool asked = false;
    for (size_t j = 0; j < used->count; j++) asked |= used->item[j]->spec == named->item[k];
    if (!asked) hk_warn(&run->warnings, "%s: no plugin of the scene asks for this service", named->item[k]->label);
  }
}

static hk_status open_shared(hk_run *run) {
  const hk_scene *scene = run->scene;
  long online = sysconf(_SC_NPROCESSORS_ONLN);
  int asked = run->options.threads > 0 ? run->options.threads : scene->threads;
  int threads = asked > 0 ? asked : online > 0 ? (int)online : 1;
  run->warnings.silent = run->options.progress < 0;
  if (run->options.caution) hk_warn(&run->warnings, "%s", run->options.caution);
  run->shared = (hk_shared){.error = &run->error, .warnings = &run->warnings, .seed = scene->seed};
  run->shared.allocations_left = run->options.allocations > 0 ? run->options.allocations - 1 : -1;
  run->shared.path = path_of;
  run->shared.query = query;
  run->shared.context = run;
  run->shared.acting = run->options.acting;
  run->shared.threads = hk_threads_create(threads);
  if (!run->shared.threads) return hk_error_set(&run->error, HK_FAILED, "cannot start %d threads", threads);
  run->folder = hk_folder_open(run->options.out, scene->name, &run->error);
  return run->folder ? HK_OK : run->error.status;
}

/* ---- plugins ---- */

/* One of the first `own` outputs is of this plugin: two would write the same files. */
static bool writes_already(const hk_instances *outputs, size_t own, const hk_plugin_spec *added) {
  bool found = false;
  for (size_t k = 0; k < own && added->plugin->kind == HK_OUTPUT; k++)
    found |= outputs->item[k]->plugin == added->plugin;
  return found;
}

/* The scene's plugins of a kind, and then those that the command line adds, but no output that the scene has. */
static hk_status make_kind(hk_run *run, hk_kind kind) {
  const hk_specs *specs = &run->scene->plugin[kind];
  const hk_overrides *o = &run->overrides;
  bool silent = kind == HK_OUTPUT && run->options.no_output, alone = kind == HK_OUTPUT && run->options.bare;
  hk_status status = HK_OK;
  for (size_t k = 0; !silent && k < specs->count && status == HK_OK; k++)
    if (!hk_overrides_leave_out(o, specs->item[k]))
      status = hk_plugins_add(&run->plugins, specs->item[k], &run->shared, NULL, &run->error);
  size_t own = run->plugins.kind[kind].count;
  for (size_t k = 0; !alone && k < o->added_count && status == HK_OK; k++)
    if (o->added[k]->plugin->kind == kind && !writes_already(&run->plugins.kind[kind], own, o->added[k]))
      status = hk_plugins_add(&run->plugins, o->added[k], &run->shared, NULL, &run->error);
  return status;
}

static hk_status make_instances(hk_run *run) {
  static const hk_kind kinds[] = {HK_FORCE, HK_CONSTRAINT, HK_CORRECTOR, HK_SOURCE, HK_OUTPUT};
  hk_status status = HK_OK;
  for (size_t k = 0; k < run->options.with_count && status == HK_OK; k++)
    status = hk_overrides_add(&run->overrides, run->scene, run->options.with[k], &run->error);
  for (size_t k = 0; k < sizeof kinds / sizeof *kinds && status == HK_OK; k++) status = make_kind(run, kinds[k]);
  if (status != HK_OK) return status;
  return hk_plugins_add(&run->plugins, run->overrides.integrator, &run->shared, NULL, &run->error);
}

static hk_status start_instance(hk_run *run, hk_instance *instance) {
  hk_status status = hk_instance_select(instance, &run->state.model, &run->error);
  if (status == HK_OK) status = hk_instance_set_time(instance, run->state.t, &run->error);
  hk_view view = hk_instance_view(instance, &run->state.view);
  if (status == HK_OK) status = hk_instance_start(instance, &view, run->state.size, &run->error);
  return run->error.status == HK_OK ? status : run->error.status; /* also of a service that it asked for */
}

static hk_status start_kind(hk_run *run, hk_kind kind) {
  hk_status status = HK_OK;
  for (size_t k = 0; k < run->plugins.kind[kind].count && status == HK_OK; k++)
    status = start_instance(run, run->plugins.kind[kind].item[k]);
  return status;
}

static hk_status check_groups(hk_run *run) {
  for (size_t k = 0; k < run->plugins.kind[HK_FORCE].count; k++) {
    const hk_plugin_spec *force = run->plugins.kind[HK_FORCE].item[k]->spec;
    bool found = !force->group;
    for (size_t g = 0; g < run->scene->groups && !found; g++)
      found = strcmp(run->scene->group_name[g], force->group) == 0;
    if (!found)
      return hk_error_set(&run->error, HK_BAD_PARAM, "%s: %s: group: no particle is in a group '%s'", force->where,
                          force->label, force->group);
  }
  return HK_OK;
}

static hk_status start_plugins(hk_run *run) {
  static const hk_kind order[] = {HK_FORCE, HK_CONSTRAINT, HK_CORRECTOR, HK_SOURCE, HK_INTEGRATOR, HK_OUTPUT};
  hk_status status = check_groups(run);
  for (size_t k = 0; k < sizeof order / sizeof *order && status == HK_OK; k++) {
    status = start_kind(run, order[k]);
    hk_dynamics_refresh(&run->dynamics); /* the forces' selections of particles are known now */
  }
  return status == HK_OK ? hk_elements_refresh(&run->dynamics) : status;
}

static const hk_instance *find_one_sided(const hk_run *run) {
  const hk_instances *list = &run->plugins.kind[HK_CONSTRAINT];
  for (size_t k = 0; k < list->count; k++)
    if (list->item[k]->plugin->constraint->flags & HK_ONE_SIDED) return list->item[k];
  return NULL;
}

/* Constraints have multipliers, implicit methods matrices: what solves them is opened now, never in a step. */
static hk_status open_linear_systems(hk_run *run) {
  const hk_integrator *method = run->step.method;
  bool constrained = run->plugins.kind[HK_CONSTRAINT].count > 0;
  if (constrained && method->without_constraints)
    return hk_error_set(&run->error, HK_BAD_PARAM, "%s takes no constraints ('%s'): %s", run->step.method_name,
                        run->plugins.kind[HK_CONSTRAINT].item[0]->label, method->without_constraints);
  const hk_instance *one_sided = find_one_sided(run);
  if (one_sided && method->flags & HK_SPLITS_FORCES)
    return hk_error_set(
        &run->error, HK_BAD_PARAM,
        "%s takes no one-sided constraints ('%s'): it splits the forces, and which constraints push is a "
        "matter of their sum; choose another implicit method",
        run->step.method_name, one_sided->label);
  hk_status status = HK_OK;
  if (constrained || method->flags & (HK_NEEDS_JACOBIAN | HK_NEEDS_SOLVER))
    status = hk_solver_open(&run->dynamics, run->overrides.solver);
  if (status == HK_OK && constrained) status = hk_constraints_open(&run->dynamics);
  bool implicit = method->flags & (HK_NEEDS_JACOBIAN | HK_NEEDS_SOLVER);
  return status == HK_OK && constrained && implicit ? hk_saddle_point_open(&run->dynamics) : status;
}

/* ---- pointers and hooks between the parts of a run ---- */

static void sample_before(void *context) {
  hk_run *run = context;
  hk_under_resolved_before(&run->loop, &run->judgement);
}

static void sample_after(void *context, double h) {
  hk_run *run = context;
  hk_under_resolved_after(&run->loop, &run->judgement, h);
}

static void note_passages(void *context, double h) {
  hk_run *run = context;
  hk_passed_by_note(&run->loop, h);
}

static void show_progress(void *context) {
  hk_run *run = context;
  hk_progress_show(&run->progress, &run->loop, &run->judgement.last_frame);
}

static hk_schedule schedule_of(const hk_run *run) {
  const hk_run_options *o = &run->options;
  hk_schedule s = {.refine = o->refine, .dt_most = o->dt_most, .step_limit = o->step_limit};
  s.cut = o->cut;
  s.cuts = o->cuts;
  s.interrupted = o->interrupted;
  if (o->refine && run->dynamics.system.flags & HK_DEPENDS_ON_T)
    s.part = golden; /* an irrational part: the cut coincides with no equal division of a frame */
  return s;
}

static void connect_parts(hk_run *run) {
  hk_loop *loop = &run->loop;
  loop->scene = run->scene;
  loop->state = &run->state;
  loop->pins = &run->pins;
  loop->plugins = &run->plugins;
  loop->dynamics = &run->dynamics;
  loop->step = &run->step;
  loop->integrator = hk_plugins_one(&run->plugins, HK_INTEGRATOR);
  loop->record = &run->record;
  loop->warnings = &run->warnings;
  loop->error = &run->error;
  loop->fps = run->scene->fps;
  loop->schedule = schedule_of(run);
  loop->population = hk_population_open(&run->state, run->scene);
  loop->hooks = (hk_loop_hooks){.context = run, .frame = hk_run_frame, .framed = hk_run_framed};
  loop->hooks.now_and_then = show_progress;
  bool repeats = run->options.refine > 0; /* the verdict is that of the first run */
  if (run->judgement.compared && !repeats && hk_passed_by_asks(loop)) loop->hooks.moved = note_passages;
  if (run->step.method->flags & HK_IMPLICIT) {
    loop->hooks.before_sample = sample_before;
    loop->hooks.after_sample = sample_after;
  }
}

static void set_method(hk_run *run) {
  const hk_instance *integrator = hk_plugins_one(&run->plugins, HK_INTEGRATOR);
  run->step.method = integrator->plugin->integrator;
  run->step.method_name = integrator->plugin->name;
  run->step.parameters = integrator->self;
  run->step.integrator = integrator;
  run->step.fps = run->scene->fps;
  run->step.dt_limit = run->step.limit_now = NAN;
  run->dynamics.system.host = &integrator->host;
  run->dynamics.system.tol = isnan(run->options.tol) ? run->scene->tol : run->options.tol;
}

/* ---- the start ---- */

static hk_status open_outputs(hk_run *run) {
  const hk_instances *outputs = &run->plugins.kind[HK_OUTPUT];
  hk_frame frame = hk_run_output_frame(run);
  hk_status status =
      run->options.no_output ? HK_OK : hk_measures_open(run->folder, run->scene, &run->measures, &run->error);
  while (status == HK_OK && run->outputs_open < outputs->count) {
    hk_instance *output = outputs->item[run->outputs_open];
    hk_view view = hk_instance_view(output, &run->state.view);
    const hk_instance *outer = hk_enter(output);
    if (output->plugin->output->open) status = output->plugin->output->open(output->self, &view, &frame);
    status = hk_leave_with(output, outer, "open", status);
    if (status == HK_OK) run->outputs_open++;
  }
  return status;
}

static hk_status first_frame(hk_run *run) {
  if (run->resumed) return open_outputs(run);
  hk_status status = hk_figures_take(&run->loop, &run->judgement, run); /* for the `open` of outputs */
  if (status == HK_OK) status = open_outputs(run);
  return status == HK_OK ? hk_loop_frame(&run->loop) : status;
}

/* A checkpoint has its step with it, unless another one is asked for now. */
static bool goes_on_with_its_step(const hk_run *run, double given) {
  const hk_step_choice *step = &run->step;
  if (!run->resumed || step->method->flags & HK_ADAPTIVE) return run->resumed;
  return isnan(given) ? step->chosen : !step->chosen && given == step->dt;
}

static hk_status start(hk_run *run) {
  const hk_instances *forces = &run->plugins.kind[HK_FORCE];
  double given = isnan(run->options.dt) ? run->scene->dt : isinf(run->options.dt) ? NAN : run->options.dt;
  hk_status status = HK_OK;
  const char *file = run->options.resume ? run->options.resume : run->scene->start_file;
  const char *origin = run->options.resume ? run->saving.origin : NULL;
  if (file) status = hk_start_file_read(&run->loop, &run->judgement, run->folder, file, origin, &run->resumed);
  if (status != HK_OK) return status;
  if (run->options.resume) hk_folder_go_on(run->folder, run->record.steps);
  for (size_t k = 0; k < forces->count; k++)
    run->dynamics.force_acts[k] = hk_force_acts_at(forces->item[k], run->state.t);
  hk_state_refresh(&run->state);
  hk_dynamics_refresh(&run->dynamics);
  status = hk_elements_refresh(&run->dynamics);
  if (status == HK_OK) status = hk_run_impose_start(run);
  if (status == HK_OK && !run->resumed) status = hk_sweep_settle(&run->dynamics);
  if (status == HK_OK) status = hk_solver_settle(&run->dynamics);
  double limit = run->step.dt_limit;
  if (status == HK_OK && !goes_on_with_its_step(run, given)) {
    run->loop.piece.n = 0;
    status = hk_step_choose(&run->step, &run->dynamics, given);
  }
  if (run->resumed && limit < run->step.dt_limit) run->step.dt_limit = limit; /* the least so far */
  if (status == HK_OK) hk_check_given_speeds(&run->loop, run->asked.end);
  if (status == HK_OK) hk_warn_of_long_steps(&run->loop);
  return status == HK_OK ? first_frame(run) : status;
}

/* The lists of the scene have the order of ids, which may not be that of the state. */
static hk_status renumber_instances(hk_run *run) {
  hk_status status = HK_OK;
  for (int kind = 0; kind < HK_KINDS && run->state.by_id; kind++)
    for (size_t k = 0; k < run->plugins.kind[kind].count && status == HK_OK; k++)
      status = hk_instance_renumber(run->plugins.kind[kind].item[k], run->state.by_id, &run->error);
  return status;
}

/* The state has its own copy of what the scene says of particles; pins take their start positions from there. */
static hk_status open_particles(hk_run *run, hk_scene *scene) {
  hk_status status = hk_state_open(&run->state, scene, &run->error);
  if (status == HK_OK) status = hk_pins_open(&run->pins, scene, &run->state, &run->error);
  if (status == HK_OK) status = hk_state_check_masses(&run->state, &run->error);
  if (run->options.only_run) hk_scene_spend(scene);
  return status;
}

static hk_status build(hk_run *run, hk_scene *scene) {
  const hk_run_options *o = &run->options;
  if (scene->spent) return hk_error_set(&run->error, HK_BAD_PARAM, "the scene's only run has been made");
  if (o->accuracy_at && strcmp(o->accuracy_at, "end") != 0 && strcmp(o->accuracy_at, "frames") != 0)
    return hk_error_set(&run->error, HK_BAD_PARAM, "accuracy_at: '%s' is neither frames nor end", o->accuracy_at);
  hk_status status = open_shared(run);
  if (status == HK_OK)
    status = hk_overrides_open(&run->overrides, run->scene, o->integrator, o->solver, o->without_count, o->without,
                               &run->error);
  if (status == HK_OK) status = open_particles(run, scene);
  if (status == HK_OK) status = make_instances(run);
  if (status == HK_OK) status = renumber_instances(run);
  if (status == HK_OK) status = hk_run_name_forces(run);
  if (status != HK_OK) return status;
  status = hk_dynamics_open(&run->dynamics, run->scene, &run->state, &run->pins, &run->plugins, &run->shared);
  if (status != HK_OK) return status;
  set_method(run);
  connect_parts(run);
  status = hk_judgement_open(&run->judgement, run->scene, &run->error);
  if (status == HK_OK) status = start_plugins(run);
  if (status == HK_OK) status = open_linear_systems(run);
  if (status == HK_OK) status = hk_publications_list(&run->dynamics); /* services have come */
  warn_of_unused_services(run);
  hk_warn_of_idle_options(run);
  if (status == HK_OK) status = hk_run_begin_saving(run);
  return status == HK_OK ? start(run) : status;
}

static bool compares(const hk_run *run) {
  static const double small = 1e6; /* positions: 32 MB; those of some frames are what a run takes beside them */
  const hk_scene *scene = run->scene;
  bool asked = run->asked.accuracy > 0;
  for (size_t k = 0; k < scene->channels && run->asked.accuracy != 0; k++)
    asked = asked || scene->channel[k].accuracy > 0;
  if (asked || run->options.compare == HK_COMPARE_ALWAYS) return true;
  return run->options.compare == HK_COMPARE_SMALL &&
         (double)scene->n * (RUN_FRAMES + scene->fps * run->asked.end) < small;
}

hk_status hk_run_open(hk_scene *scene, const hk_run_options *options, hk_run **made, hk_error *error) {
  hk_run *run = calloc(1, sizeof *run);
  if (!run) return hk_error_set(error, HK_NO_MEMORY, "no memory for a run");
  run->scene = scene;
  run->options = *options;
  run->interruption = (hk_interruption){run, hk_run_interrupted_again};
  run->record.dt_min = INFINITY;
  run->asked.end = isnan(options->until) ? scene->duration : options->until;
  run->asked.accuracy = isnan(options->accuracy) ? scene->accuracy : options->accuracy;
  run->asked.at_end = options->accuracy_at ? strcmp(options->accuracy_at, "end") == 0 : scene->accuracy_at_end;
  run->asked.ignore_exact = options->ignore_exact;
  run->judgement.compared = compares(run);
  run->asked.opened_at = hk_clock();
  run->progress =
      (hk_progress){.mode = options->progress, .begin = INFINITY, .end = run->asked.end, .at = run->asked.opened_at};
  scene->frozen = true;
  hk_status status = build(run, scene);
  if (status != HK_OK) {
    hk_error_set(error, status, "%s", run->error.text);
    hk_run_close(run, NULL);
    hk_run_destroy(run);
    return status;
  }
  run->progress.begin = run->state.t;
  run->progress.steps = run->record.steps;
  *made = run;
  return HK_OK;
}

void hk_run_destroy(hk_run *run) {
  if (!run) return;
  hk_dynamics_close(&run->dynamics);
  hk_plugins_clear(&run->plugins);
  hk_spec_destroy(run->dynamics.solver_spec);
  hk_spec_destroy(run->dynamics.special_spec);
  for (size_t k = 0; k < run->services; k++) hk_spec_destroy(run->service_spec[k]);
  free(run->service_spec);
  hk_overrides_close(&run->overrides);
  hk_loop_close(&run->loop);
  hk_judgement_close(&run->judgement);
  free(run->force_name);
  hk_pins_close(&run->pins);
  hk_state_close(&run->state);
  hk_folder_close(run->folder);
  hk_run_end_saving(run);
  hk_warnings_clear(&run->warnings);
  hk_threads_destroy(run->shared.threads);
  free(run);
}
