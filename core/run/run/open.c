/* Opening a run. Each part is built after the parts that it needs: state, pins, instances of the plugins, dynamics,
 * solver, constraints, the start state, the step size, the outputs. When one of them fails, hk_run_destroy frees those
 * that exist; it therefore accepts a partly built run. */
#include "core/numerics/step_choice/step_choice.h"
#include "core/run/run/install.h"
#include "core/run/run/run.h"

#include <stdlib.h>
#include <string.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <unistd.h>

enum { RUN_FRAMES = 25 }; /* a run takes some 800 bytes a particle, a frame 32 */
static const double golden = 0.61803398874989485;

/* ---- what all plugins share ---- */

static hk_status path_of(void *context, const char *owner, const char *name, char *buffer, size_t size) {
  hk_run *run = context;
  return hk_folder_path(run->folder, owner, name, buffer, size, &run->error);
}

/* Calls of plugins after each of which it is seen whether they left the process as it was: 2 us each. */
enum { FIRST_CALLS = 64 };

static hk_status open_shared(hk_run *run) {
  const hk_scene *scene = run->scene;
  long online = sysconf(_SC_NPROCESSORS_ONLN);
  int asked = run->options.threads > 0 ? run->options.threads : scene->threads;
  int threads = asked > 0 ? asked : online > 0 ? (int)online : 1;
  run->warnings.silent = run->options.progress < 0;
  if (run->options.caution) hk_warn(&run->warnings, "%s", run->options.caution);
  run->shared = (hk_shared){.error = &run->error, .warnings = &run->warnings, .seed = scene->seed};
  run->shared.allocations_left = run->options.allocations > 0 ? run->options.allocations - 1 : -1;
  run->shared.lanes = run->options.lanes > 0 ? run->options.lanes : hk_processor_lanes();
  run->shared.path = path_of;
  run->shared.query = hk_run_query;
  run->shared.context = run;
  run->shared.acting = run->options.acting;
  run->shared.disturbed = run->options.disturbed;
  run->shared.surveys = run->options.disturbed ? FIRST_CALLS : 0;
  run->shared.registry = scene->registry;
  run->shared.threads = hk_threads_create(threads);
  if (!run->shared.threads) return hk_error_set(&run->error, HK_FAILED, "cannot start %d threads", threads);
  hk_threads_watch(run->shared.threads, run->options.thread_ended);
  run->folder = hk_folder_open(run->options.out, scene->name, &run->error);
  if (run->folder) hk_folder_spare(run->folder, run->options.taken);
  return run->folder ? HK_OK : run->error.status;
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

static void note_encounters(void *context, double h) {
  hk_run *run = context;
  hk_missed_encounters_note(&run->loop, h);
}

static void show_progress(void *context) {
  hk_run *run = context;
  hk_progress_show(&run->progress, &run->loop, &run->judgement.last_frame);
}

/* What comes back to its start at every frame moves between them. */
static void note_reach(void *context) {
  hk_run *run = context;
  run->record.reach = fmax(run->record.reach, hk_trajectory_reach(&run->judgement.trajectory, &run->state));
}

/* s, 0: no limit. A dt that is asked for is the longest step of an adaptive method, too; that of a scene, which is
 * meant for its own method, is where one begins. */
static double longest_step(const hk_run *run) {
  const hk_run_options *o = &run->options;
  bool given = run->loop.method->flags & HK_ADAPTIVE && o->refine == 0 && isfinite(o->dt);
  if (!given) return o->dt_most;
  return o->dt_most > 0 ? fmin(o->dt_most, o->dt) : o->dt;
}

static hk_schedule schedule_of(const hk_run *run) {
  const hk_run_options *o = &run->options;
  hk_schedule s = {.refine = o->refine, .dt_most = longest_step(run), .step_limit = o->step_limit};
  s.cut = o->cut;
  s.cuts = o->cuts;
  s.interrupted = o->interrupted;
  if (o->refine && run->dynamics.queries.flags & HK_DEPENDS_ON_T)
    s.part = golden; /* an irrational part: the cut coincides with no equal division of a frame */
  return s;
}

static void connect_parts(hk_run *run) {
  hk_loop *loop = &run->loop;
  hk_loop_open(loop, &run->dynamics, &run->step->length, &run->record, run->scene->fps);
  loop->schedule = schedule_of(run);
  loop->hooks = (hk_loop_hooks){.context = run, .frame = hk_run_frame, .framed = hk_run_framed};
  loop->hooks.now_and_then = show_progress;
  if (run->judgement.keeps_trajectory) loop->hooks.passing = note_reach;
  bool repeats = run->options.refine > 0; /* the verdict is that of the first run */
  if (run->judgement.keeps_trajectory && !repeats && hk_missed_encounters_asks(loop))
    loop->hooks.moved = note_encounters;
  if (run->loop.method->flags & HK_IMPLICIT) {
    loop->hooks.before_sample = sample_before;
    loop->hooks.after_sample = sample_after;
  }
}

/* What is asked for on the command line, by the scene, or else what suits the method. */
static double tolerance(const hk_run *run) {
  if (!isnan(run->options.tol)) return run->options.tol;
  return isnan(run->scene->tol) ? run->step->tol : run->scene->tol;
}

static hk_status set_method(hk_run *run) {
  run->step = hk_step_choice_open(hk_plugins_one(&run->plugins, HK_INTEGRATOR), run->scene->fps);
  if (!run->step) return hk_error_set(&run->error, HK_NO_MEMORY, "no memory for the choice of the step");
  run->dynamics.system.tol = tolerance(run);
  return HK_OK;
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
  const hk_step_choice *step = run->step;
  if (!run->resumed || step->method->flags & HK_ADAPTIVE) return run->resumed;
  return isnan(given) ? step->chosen : !step->chosen && given == step->length.dt;
}

/* A run does not go back: its end would be taken for the state of an earlier time. */
static hk_status check_time(hk_run *run, const char *file) {
  if (run->state.t <= run->asked.end + 1e-9 / run->scene->fps) return HK_OK;
  return hk_error_set(&run->error, HK_BAD_PARAM, "%s is of t = %g s, after the end that is asked for, %g s", file,
                      run->state.t, run->asked.end);
}

/* What a user changes is his doing, as what his hand moves: the energy that it gives is work, and no other run repeats
 * it. Where the checkpoint was taken between frames, that energy is not known. */
static hk_status take_changes(hk_run *run, const char *said) {
  hk_state *s = &run->state;
  hk_record *r = &run->record;
  const hk_frame *f = &run->judgement.last_frame;
  bool at_frame = r->frames > 0 && fabs(s->t * run->scene->fps - (double)(r->frames - 1)) < 1e-9;
  hk_status status = hk_forces_settle(&run->dynamics);
  if (status != HK_OK) return status;
  double now = hk_state_kinetic(s, s->X) + hk_query_potential(&run->dynamics, s->t, s->X);
  double gained = now - f->kinetic - f->potential;
  char energy[64] = "", pins[96] = "";
  if (at_frame && hk_query_has_energy(&run->dynamics)) {
    s->X[s->size - 1] += gained;
    snprintf(energy, sizeof energy, ", and the energy changes by %.4g J", gained);
  } else
    r->corrected = true;
  r->by_hand = true;
  hk_step_reset(&run->loop, HK_STATE_CHANGED);
  if (run->pins_jump > 1e-9 * hk_state_extent(s))
    snprintf(pins, sizeof pins, " but for pins, which jump by %.3g m to where they are by it", run->pins_jump);
  hk_warn(&run->warnings, "from t = %.6g s on %s: positions, velocities and masses stay as they are%s%s", s->t, said,
          pins, energy);
  return HK_OK;
}

static hk_status start(hk_run *run) {
  double given = isnan(run->options.dt) ? run->scene->dt : isinf(run->options.dt) ? NAN : run->options.dt;
  hk_status status = HK_OK;
  const char *file = run->options.resume ? run->options.resume : run->scene->start_file;
  const char *origin = run->options.resume ? run->saving.origin : NULL;
  hk_origin_changes changes = {run->options.change_count, run->options.change, ""};
  if (file)
    status = hk_start_file_read(&run->loop, &run->judgement, run->folder, file, origin, &changes, &run->resumed);
  if (status == HK_OK && run->resumed) status = check_time(run, file);
  if (status != HK_OK) return status;
  if (run->options.resume) hk_folder_go_on(run->folder, run->record.steps);
  status = hk_dynamics_begin(&run->dynamics);
  if (status == HK_OK) status = hk_install_losses(&run->loop, run->resumed);
  if (status == HK_OK) status = hk_run_impose_start(run);
  if (status == HK_OK && !run->resumed) status = hk_forces_settle(&run->dynamics);
  if (status == HK_OK) status = hk_install_chosen_solver(&run->dynamics);
  bool changed = run->resumed && *changes.said;
  if (status == HK_OK && changed) status = take_changes(run, changes.said);
  double limit = run->step->dt_limit;
  if (status == HK_OK && (changed || !goes_on_with_its_step(run, given))) {
    run->loop.piece.n = 0;
    status = hk_step_choose(run->step, &run->dynamics, given);
  }
  if (run->resumed && limit < run->step->dt_limit) run->step->dt_limit = limit; /* the least so far */
  if (status == HK_OK) hk_check_given_speeds(&run->loop, run->asked.end);
  if (status == HK_OK) hk_warn_of_long_steps(&run->loop);
  return status == HK_OK ? first_frame(run) : status;
}

/* With a source nobody knows how many particles there will be. */
static hk_status check_exact(hk_run *run) {
  const hk_scene *scene = run->scene;
  if (run->asked.ignore_exact || scene->plugin[HK_SOURCE].count) return HK_OK;
  return hk_figures_check_exact(scene, scene->particles.n, run->asked.end, &run->error);
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
  if (scene->particles.n == 0 && scene->plugin[HK_SOURCE].count == 0)
    return hk_error_set(&run->error, HK_BAD_PARAM,
                        "the scene is empty: add particles (scene:particle, scene:grid, ...) or a source");
  hk_status status = hk_state_open(&run->state, &scene->particles, hk_scene_places(scene), &run->error);
  if (hk_box_repeats(&scene->box)) run->state.model.box = &scene->box;
  if (status == HK_OK) status = hk_riders_open(&run->state, &run->error);
  if (status == HK_OK) status = hk_pins_open(&run->pins, &run->state, &run->error);
  if (status == HK_OK) status = hk_install_motions(&run->pins, scene->duration, &run->error);
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
  if (status == HK_OK) status = hk_run_make_plugins(run);
  if (status == HK_OK) status = renumber_instances(run);
  if (status == HK_OK) status = hk_run_name_forces(run);
  if (status != HK_OK) return status;
  status = hk_dynamics_open(&run->dynamics, &run->state, &run->pins, &run->plugins, &run->shared);
  if (status != HK_OK) return status;
  hk_install_matrices(&run->dynamics);
  if (run->dynamics.queries.flags & HK_DEPENDS_ON_T &&
      !hk_evaluations_open(&run->dynamics.evaluations, scene->duration))
    return hk_error_set(&run->error, HK_NO_MEMORY, "no memory for the times of evaluations");
  status = set_method(run);
  if (status != HK_OK) return status;
  connect_parts(run);
  status = hk_install_sources(&run->loop);
  if (status != HK_OK) return status;
  status = hk_judgement_open(&run->judgement, run->scene, &run->error);
  if (status == HK_OK) status = hk_run_start_plugins(run);
  if (status == HK_OK) status = hk_install_solvers(&run->dynamics, run->loop.integrator, run->overrides.solver);
  if (status == HK_OK) status = hk_publications_list(&run->dynamics); /* services have come */
  if (status == HK_OK) hk_warn_of_no_effect(run);
  hk_warn_of_unused_services(run);
  hk_warn_of_unused_options(run);
  if (status == HK_OK) status = hk_run_begin_saving(run);
  if (status == HK_OK) status = check_exact(run);
  return status == HK_OK ? start(run) : status;
}

static bool compares(const hk_run *run) {
  static const double small = 1e6; /* positions: 32 MB; those of some frames are what a run takes beside them */
  const hk_scene *scene = run->scene;
  bool asked = run->asked.accuracy > 0;
  for (size_t k = 0; k < scene->particles.channels && run->asked.accuracy != 0; k++)
    asked = asked || scene->particles.channel[k].accuracy > 0;
  if (asked || run->options.compare == HK_COMPARE_ALWAYS) return true;
  return run->options.compare == HK_COMPARE_SMALL &&
         (double)scene->particles.n * (RUN_FRAMES + scene->fps * run->asked.end) < small;
}

/* Memory that building has freed goes back to the system: glibc keeps what is below its threshold, up to 32 MB each. Of
 * small scenes that is little, and a look at all of the heap. */
static void give_back(const hk_run *run) {
  enum { SMALL = 20000 }; /* particles, with some 10 MB */
  (void)run;
#ifdef __GLIBC__
  if (run->state.model.n > SMALL) malloc_trim(0);
#endif
}

hk_status hk_run_open(hk_scene *scene, const hk_run_options *options, hk_run **made, hk_error *error) {
  hk_run *run = calloc(1, sizeof *run);
  if (!run) return hk_error_set(error, HK_NO_MEMORY, "no memory for a run");
  run->scene = scene;
  run->options = *options;
  run->interruption = (hk_interruption){run, hk_run_interrupted_again};
  run->asked.end = isnan(options->until) ? scene->duration : options->until;
  run->asked.accuracy = isnan(options->accuracy) ? scene->accuracy : options->accuracy;
  run->asked.at_end = options->accuracy_at ? strcmp(options->accuracy_at, "end") == 0 : scene->accuracy_at_end;
  run->asked.ignore_exact = options->ignore_exact;
  run->judgement.keeps_trajectory = compares(run);
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
  give_back(run);
  *made = run;
  return HK_OK;
}

void hk_run_destroy(hk_run *run) {
  if (!run) return;
  hk_install_close(&run->dynamics, &run->loop);
  hk_dynamics_close(&run->dynamics);
  hk_plugins_clear(&run->plugins);
  hk_spec_destroy(run->dynamics.solver_spec);
  hk_spec_destroy(run->dynamics.special_spec);
  for (size_t k = 0; k < run->services; k++) hk_spec_destroy(run->service_spec[k]);
  free(run->service_spec);
  hk_overrides_close(&run->overrides);
  hk_loop_close(&run->loop);
  free(run->step);
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
