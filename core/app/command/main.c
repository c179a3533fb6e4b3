/* hooke: the command line. `run` is built in; `hooke NAME` runs tools/NAME.lua. Only here does the process exit, read
 * the environment or catch a signal. */
#include "core/app/command/auto.h"
#include "core/engine/base/base.h"
#include "core/app/installation/installation.h"
#include "core/app/options/options.h"
#include "core/app/command/resume.h"
#include "core/engine/host/host.h"
#include "core/app/process/process.h"
#include "core/run/report/report.h"
#include "core/app/lua/lua.h"
#include "core/engine/text/text.h"
#include "core/app/tools/tools.h"

#include <errno.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define HK_VERSION "0.3.0"
/* With what hooke itself is compiled: the same bits for any vectors, and vectors of roots and conditions. */
#define HK_NUMBER_FLAGS "-ffp-contract=off -fno-math-errno -fno-trapping-math"

static volatile sig_atomic_t interrupted;

/* s from one time to a later one. */
static double seconds_between(const struct timespec *from, const struct timespec *to) {
  return (double)(to->tv_sec - from->tv_sec) + 1e-9 * (double)(to->tv_nsec - from->tv_nsec);
}

/* The first signal asks for an orderly end, with everything kept; a second one ends what does not come to it. Some
 * senders, such as timeout(1), send twice at once: that is one signal. */
static void interrupt(int signal_number) {
  static struct timespec first;
  struct timespec now;
  (void)signal_number;
  clock_gettime(CLOCK_MONOTONIC, &now);
  if (!interrupted) first = now;
  double since = seconds_between(&first, &now);
  if (interrupted && since < 0.5) return;
  if (interrupted < 100) interrupted = interrupted + 1;
  hk_faults_interrupt(); /* ends the process where a plugin is at work at the second signal */
  if (since > 1) _exit(130);
}

static int exit_code(hk_status status) {
  switch (status) {
  case HK_OK:
    return 0;
  case HK_BAD_PARAM:
  case HK_SCRIPT:
  case HK_NO_MEMORY: /* of this machine, and no plugin's fault */
    return 1;
  case HK_FAILED:
    return 2;
  case HK_NOT_FINITE:
  case HK_NOT_CONVERGED:
    return 3;
  case HK_IO:
    return 4;
  case HK_INTERRUPTED:
    return 130;
  }
  return 2;
}

static int verdict_code(hk_verdict verdict) {
  return verdict == HK_INACCURATE ? 5 : verdict == HK_DIVERGED ? 3 : verdict == HK_STOPPED ? 130 : 0;
}

static int complain(const hk_error *error) {
  fprintf(stderr, "hooke: %s\n", error->text);
  return exit_code(error->status);
}

static hk_script_options script_options(const hk_options *o, hk_registry *registry, const char *library) {
  hk_script_options options = hk_options_of_script(o, registry, library);
  options.pulse = o->trust ? NULL : hk_watchdog_start(&interrupted);
  return options;
}

/* ---- one run of a scene ---- */

/* To the end, outputs closed, the state written: whatever happens on the way, what there is is kept. */
static hk_status finish(hk_run *run, const hk_options *o, hk_error *error) {
  hk_status status = hk_run_advance(run, hk_run_end(run), error);
  hk_faults_returned();
  hk_error later = {0};
  hk_status closed = hk_run_close(run, &later);
  if (o->state && closed == HK_OK)
    closed = hk_run_write_state(run, o->state, &later);
  else if (o->state)
    hk_run_write_state(run, o->state, NULL);
  if (status != HK_OK) {
    if (closed != HK_OK) fprintf(stderr, "hooke: %s\n", later.text);
    return status;
  }
  if (closed != HK_OK) hk_error_set(error, closed, "%s", later.text);
  return closed;
}

static bool write_report(FILE *file, const void *summary) {
  hk_report_json(file, summary);
  return !ferror(file);
}

static hk_status write_summary(const hk_options *o, const hk_summary *s, hk_error *error) {
  hk_error cause = {0};
  hk_status status = o->summary ? hk_write_file(o->summary, write_report, s, &cause) : HK_OK;
  return status == HK_OK ? HK_OK : hk_error_set(error, status, "--summary: %s", cause.text);
}

static void report(const hk_options *o, const hk_scene *scene, hk_summary *s) {
  char out[PATH_MAX];
  snprintf(out, sizeof out, o->run.out ? "%s" : "out/%s", o->run.out ? o->run.out : scene->name);
  bool wrote = !o->run.no_output && (scene->plugin[HK_OUTPUT].count || scene->measures);
  if (o->json)
    hk_report_json(stdout, s);
  else if (!o->quiet)
    hk_report_text(stdout, s, wrote ? out : NULL);
}

static int run_scene(hk_script *script, const hk_options *o, hk_registry *registry, const char *library) {
  hk_error error = {0};
  hk_run *run;
  hk_scene *scene = hk_script_scene(script);
  hk_run_options first = o->run;
  first.only_run = true; /* the script is over; runs for comparisons are of scenes of their own */
  hk_status status = hk_run_open(scene, &first, &run, &error);
  if (status != HK_OK) return complain(&error);
  hk_script_options options = script_options(o, registry, library);
  if (!o->trust)
    hk_script_runtime_estimate(o->scene, &options, &o->run, run); /* as in run_command: not run again unasked */
  status = finish(run, o, &error);
  hk_keep_end();
  hk_summary summary;
  hk_run_summary(run, &summary);
  if (status == HK_OK) {
    hk_error second = {0};
    if (hk_script_verify(o->scene, &options, &o->run, o->verify, run, &summary, &second) != HK_OK)
      fprintf(stderr, "hooke: with half the step: %s\n", second.text);
  }
  hk_error last = {0};
  hk_status left = hk_run_write_summary(run, &summary, &last);
  if (left != HK_OK && status != HK_OK)
    fprintf(stderr, "hooke: %s\n", last.text);
  else if (left != HK_OK)
    status = left, error = last;
  if (status == HK_OK)
    status = write_summary(o, &summary, &error);
  else
    write_summary(o, &summary, &last);
  int code = status == HK_OK ? verdict_code(summary.verdict) : exit_code(status);
  report(o, scene, &summary);
  if (status != HK_OK) complain(&error);
  hk_run_destroy(run);
  return code;
}

static void catch_signals(void) {
  struct sigaction action = {.sa_handler = interrupt};
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
}

typedef struct surroundings {
  const hk_registry *registry;
  const hk_installation *installation;
} surroundings;

/* What every scene's process reads. */
static hk_confinement needs_of(const surroundings *here, const char *scene, char native[PATH_MAX + 16]) {
  const hk_installation *p = here->installation;
  if (snprintf(native, PATH_MAX + 16, "%s/../tools", p->plugins) >= PATH_MAX + 16) native[0] = 0;
  hk_confinement c = {.scene = scene, .read = {p->plugins, p->scripts, p->tools, native}};
  c.search = here->registry->search;
  c.libraries = getenv("LD_LIBRARY_PATH");
  return c;
}

/* For tools: a case in a process of its own writes nothing but its result, to a pipe; others a page or a table. */
static const char *confine_tool(void *context, const char *path, const char *other, const char *folder) {
  char native[PATH_MAX + 16];
  hk_confinement c = needs_of(context, path, native);
  c.read[4] = other;
  c.output = folder, c.named = true;
  return hk_confine(&c);
}

/* Where tools/auto.lua keeps its choices. */
static const char *cache_folder(char *folder, size_t size) {
  const char *base = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
  bool given = base && *base;
  if (!given && !(home && *home)) return NULL;
  int length = snprintf(folder, size, given ? "%s/hooke" : "%s/.cache/hooke", given ? base : home);
  return length < (int)size ? folder : NULL;
}

/* Before the script and before any thread: what an untrusted scene has no use for is given up. */
static const char *confine(const hk_options *o, const hk_registry *registry, const hk_installation *p) {
  char output[PATH_MAX], native[PATH_MAX + 16], cache[PATH_MAX];
  const char *slash = strrchr(o->scene, '/'), *name = slash ? slash + 1 : o->scene;
  size_t length = strlen(name);
  if (length > 4 && strcmp(name + length - 4, ".lua") == 0) length -= 4;
  bool fine = snprintf(output, sizeof output, "out/%.*s", (int)length, name) < (int)sizeof output;
  fine = fine && strcmp(output, "out/.") != 0 && strcmp(output, "out/..") != 0; /* as the folder itself: nameless */
  surroundings here = {registry, p};
  hk_confinement c = needs_of(&here, o->scene, native);
  c.programs = getenv("PATH");
  c.output = (o->run.no_output && !o->run.with_count) || o->help ? NULL
             : o->run.out                                        ? o->run.out
             : fine                                              ? output
                                                                 : NULL;
  c.named = o->run.out != NULL;
  c.cache = cache_folder(cache, sizeof cache);
  c.written[0] = o->state;
  c.written[1] = o->summary;
  c.read[4] = o->run.resume; /* the user names it */
  return hk_confine(&c);
}

/* Before the scene's script, which may take its time. */
static hk_status try_targets(const hk_options *o, hk_error *error) {
  const char *const option[] = {"--state", "--summary"}, *const path[] = {o->state, o->summary};
  const char *const read[] = {o->scene, o->run.resume};
  hk_status status = HK_OK;
  for (size_t k = 0; k < 2 && status == HK_OK && !o->help; k++)
    if (path[k]) status = hk_target_file(option[k], path[k], error);
  for (size_t k = 0; k < 4 && status == HK_OK; k++)
    status = hk_target_spares(option[k / 2], path[k / 2], read[k % 2], error);
  if (status == HK_OK) status = hk_target_differs(option, path, error);
  for (size_t k = 0; k < 2 && status == HK_OK && !o->run.no_output; k++)
    status =
        hk_target_differs((const char *const[]){"--out", option[k]}, (const char *const[]){o->run.out, path[k]}, error);
  bool writes = o->run.out && !o->run.no_output && !o->help;
  return status == HK_OK && writes ? hk_target_folder("--out", o->run.out, error) : status;
}

/* What a run of the process has beside its options: signals, the watch over plugins, the confinement. */
static void prepare(hk_options *o, hk_registry *registry, const hk_installation *p) {
  catch_signals();
  o->run.interrupted = &interrupted;
  o->run.compare = hk_options_comparison(o);
  o->run.acting = hk_faults_watch(registry);
  o->run.disturbed = hk_settings_watch();
  o->run.thread_ended = hk_settings_thread_ended;
  if (o->state) hk_keep_begin(o->state);
  o->run.kept = hk_keep_frame;
  o->run.progress = o->quiet ? 0 : isatty(STDERR_FILENO) ? 2 : 1;
  if (!o->trust) o->run.caution = confine(o, registry, p);
}

static int run_command(int argc, char **argv, hk_registry *registry, const hk_installation *p) {
  hk_error error = {0};
  hk_options o;
  hk_script *script = NULL;
  hk_choice choice = {.dt = NAN};
  char library[PATH_MAX + 8], **list = NULL, *text = NULL, *words = NULL;
  snprintf(library, sizeof library, "%s/lib", p->scripts);
  int code = 0;
  hk_status parsed = hk_resume_expand(&argc, &argv, &list, &text, &error);
  if (parsed == HK_OK) words = hk_resume_words(argc, argv);
  o = (hk_options){0};
  if (parsed == HK_OK) parsed = hk_options_parse(&o, argc, argv, &error);
  if (parsed == HK_OK && o.scene) hk_resume_folder(&o);
  if (parsed == HK_OK) parsed = try_targets(&o, &error);
  o.run.words = words;
  const char *const taken[][2] = {{o.state ? "--state" : "--summary", o.state ? o.state : o.summary},
                                  {o.state && o.summary ? "--summary" : NULL, o.summary},
                                  {NULL}};
  if (o.state || o.summary) o.run.taken = taken;
  if (parsed != HK_OK) {
    code = complain(&error);
  } else if (o.help && !o.scene) {
    hk_options_print();
  } else {
    prepare(&o, registry, p);
    hk_script_options options = script_options(&o, registry, library);
    hk_verdict worst = HK_VERDICT_OK;
    hk_status status = hk_script_open(o.scene, &options, &script, &error);
    if (o.help) {
      if (!o.json) hk_options_print();
      if (script && (status == HK_OK || !o.json)) hk_parameters_print(script, o.json);
      if (status != HK_OK && (o.json || !script)) code = complain(&error);
    } else if (status != HK_OK)
      code = complain(&error);
    else if (hk_script_drove(script, &worst))
      code = verdict_code(worst);
    else if (hk_auto_asked(&o, hk_script_scene(script)) &&
             hk_auto_choose(&o, hk_script_scene(script), p->tools, &options, &choice, &error) != HK_OK)
      code = complain(&error);
    else
      code = run_scene(script, &o, registry, library);
  }
  hk_script_close(script);
  hk_confinement_end();
  free(o.given);
  free(o.with);
  free(o.change);
  free(words);
  free(list);
  free(text);
  return code;
}

/* ---- tools ---- */

static int tool_command(int argc, char **argv, hk_registry *registry, const hk_installation *p) {
  char path[PATH_MAX + 128], library[PATH_MAX + 8];
  hk_error error = {0};
  snprintf(library, sizeof library, "%s/lib", p->scripts);
  if (hk_installation_tool(p, argv[0], path, &error) != HK_OK) return complain(&error);
  hk_run_options run = {.dt = NAN, .tol = NAN, .until = NAN, .accuracy = NAN, .interrupted = &interrupted};
  run.acting = hk_faults_watch(registry);
  hk_script_options options = {.registry = registry, .library = library, .trust = true, .run = &run};
  options.pulse = hk_watchdog_start(&interrupted);
  surroundings here = {registry, p};
  options.confiner = (hk_confiner){confine_tool, &here};
  int code = 0;
  if (hk_tool_run(path, argc, argv, &options, &code, NULL, &error) != HK_OK) return complain(&error);
  return code;
}

/* `hooke run ... --watch`: tools/watch.lua starts the run itself, in a process of its own. */
static bool is_watched(int argc, char **argv) {
  static char watch[] = "watch";
  if (!hk_option_given(argc, argv, "--watch") || hk_option_given(argc, argv, "--help")) return false;
  argv[-1] = watch;
  return true;
}

int main(int argc, char **argv) {
  if (hk_keep_asked(argc, argv)) return hk_keep_write(argv);
  hk_error error = {0};
  if (hk_standard_files_open(&error) != HK_OK) return complain(&error);
  hk_installation p = {0};
  hk_registry registry;
  static const char own[] = "HOOKE_PLUGIN_PATH";
  if (hk_installation_find(&p, NULL, &error) != HK_OK || hk_installation_programs(&error) != HK_OK ||
      hk_installation_absolute(own, getenv(own), &error) != HK_OK ||
      hk_registry_open(&registry, p.plugins, getenv(own), &error) != HK_OK)
    return complain(&error);
  int code;
  bool helps =
      argc > 1 && (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0 || strcmp(argv[1], "help") == 0);
  char option[] = "--help", word[] = "help", *about[] = {argv[0], helps && argc > 2 ? argv[2] : NULL, option, NULL};
  if (helps && argc > 2) { /* hooke help NAME: hooke NAME --help; other words, and several, are the tool's */
    argv[1] = word;
    if (argc == 3 && hk_installation_command(&p, about[1])) argv = about;
    helps = false;
  }
  if (argc < 2 || helps) {
    printf("hooke " HK_VERSION ": particles, strings, hair, cloth, rigid bodies and liquids\n\n");
    hk_installation_help(&p);
    code = argc < 2;
  } else if (strcmp(argv[1], "--version") == 0) {
    printf("hooke " HK_VERSION "\n");
    code = 0;
  } else if (strcmp(argv[1], "--cflags") == 0) {
    hk_installation_flags(&p, HK_NUMBER_FLAGS);
    code = 0;
  } else if (strcmp(argv[1], "run") == 0 && !is_watched(argc - 2, argv + 2))
    code = run_command(argc - 2, argv + 2, &registry, &p);
  else
    code = tool_command(argc - 1, argv + 1, &registry, &p);
  hk_registry_close(&registry);
  if (hk_standard_output_end(&error) != HK_OK && (code == 0 || code == 5)) code = complain(&error);
  return hk_faults_leave(code);
}
