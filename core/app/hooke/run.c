/* Advancing, finishing and stopping a run of libhooke, and its results. */
#include "core/app/hooke/internal.h"

#include <stdlib.h>

void hooke_stop(hooke_run *run) {
  if (run) run->stopped = 1;
}

static hooke_status check_running(hooke_run *run, const char *call) {
  if (run->busy)
    return hooke_fail(run, HK_BAD_PARAM, "%s: the run is taking steps: call it when hooke_advance has returned", call);
  if (run->stage == HOOKE_NEW)
    return hooke_fail(run, HK_BAD_PARAM, "%s: the run has no scene yet: hooke_open comes first", call);
  if (run->stage == HOOKE_ENDED)
    return hooke_fail(run, HK_BAD_PARAM, "%s: the run has ended: make another one (hooke_new)", call);
  return HOOKE_OK;
}

static hk_status advance(hooke_run *run, double t, hk_error *error) {
  double end = hk_run_end(run->run);
  run->busy = true;
  hk_status status = hk_run_advance(run->run, t < end ? t : end, error);
  run->busy = false;
  if (status != HK_OK) run->stage = HOOKE_ENDED;
  return status;
}

hooke_status hooke_advance(hooke_run *run, double t) {
  if (!run) return HOOKE_BAD_PARAM;
  hooke_surroundings own;
  hk_error error = {0};
  hooke_status status = check_running(run, "hooke_advance");
  if (status != HOOKE_OK) return status;
  if (isnan(t)) return hooke_fail(run, HK_BAD_PARAM, "hooke_advance: the time is no number");
  hooke_enter(&own);
  advance(run, t, &error);
  hooke_leave(&own);
  return hooke_failed(run, &error);
}

/* The run is judged by what it measured, and compared with others. That a run with half the step failed is in the
 * verdict. */
static hk_status judge(hooke_run *run, hk_error *error) {
  hk_summary summary;
  hk_error half = {0};
  hk_run_summary(run->run, &summary);
  hk_script_verify(run->options.scene, &run->script_options, &run->options.run, run->options.verify, run->run, &summary,
                   &half);
  return hk_run_write_summary(run->run, &summary, error);
}

static hk_status finish(hooke_run *run, hk_error *error) {
  hk_error later = {0};
  hk_status status = advance(run, hk_run_end(run->run), error);
  hk_status closed = hk_run_close(run->run, &later);
  run->stage = HOOKE_ENDED;
  if (status == HK_OK && closed == HK_OK) return judge(run, error);
  if (status == HK_OK) *error = later;
  return hk_run_write_summary(run->run, NULL, &later), error->status;
}

hooke_status hooke_finish(hooke_run *run) {
  if (!run) return HOOKE_BAD_PARAM;
  hooke_surroundings own;
  hk_error error = {0};
  hooke_status status = check_running(run, "hooke_finish");
  if (status != HOOKE_OK) return status;
  hooke_enter(&own);
  finish(run, &error);
  hooke_leave(&own);
  return hooke_failed(run, &error);
}

/* ---- results ---- */

typedef hk_status write_function(hk_run *, const char *path, hk_error *error);

static hooke_status write_with(hooke_run *run, write_function *write, const char *call, const char *path) {
  hooke_surroundings own;
  hk_error error = {0};
  if (!run) return HOOKE_BAD_PARAM;
  if (!run->run) return hooke_fail(run, HK_BAD_PARAM, "%s: no scene has been opened", call);
  if (run->busy) return check_running(run, call);
  if (!path || !*path) return hooke_fail(run, HK_BAD_PARAM, "%s: the path of the file is missing", call);
  hooke_enter(&own);
  if (hk_target_file(call, path, &error) == HK_OK) write(run->run, path, &error);
  hooke_leave(&own);
  return hooke_failed(run, &error);
}

hooke_status hooke_checkpoint(hooke_run *run, const char *path) {
  return write_with(run, hk_run_save, "hooke_checkpoint", path);
}

hooke_status hooke_write_state(hooke_run *run, const char *path) {
  return write_with(run, hk_run_write_state, "hooke_write_state", path);
}

/* *text is anew what `write` writes of the run; NULL: there is no memory. */
static const char *text_of(hooke_run *run, char **text, void (*write)(FILE *, hooke_run *)) {
  hooke_surroundings own;
  size_t size;
  hooke_enter(&own);
  free(*text);
  *text = NULL;
  FILE *file = open_memstream(text, &size);
  if (file) {
    write(file, run);
    fclose(file);
  }
  hooke_leave(&own);
  return *text;
}

static void write_summary(FILE *file, hooke_run *run) {
  hk_summary summary;
  hk_run_summary(run->run, &summary);
  hk_report_json(file, &summary);
}

const char *hooke_summary(hooke_run *run) {
  return run && run->run ? text_of(run, &run->summary, write_summary) : NULL;
}

static void write_parameters(FILE *file, hooke_run *run) { hk_parameters_write(file, run->script); }

const char *hooke_parameters(hooke_run *run) {
  return run && run->run ? text_of(run, &run->declared, write_parameters) : NULL;
}

const char *hooke_verdict(const hooke_run *run) {
  return run && run->run ? hk_verdict_name(run->run->judgement.verdict) : "running";
}
