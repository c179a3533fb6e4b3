/* Looking at a run of libhooke: pointers into its state. */
#include "core/app/hooke/internal.h"

#include <string.h>

static const hk_view *view_of(const hooke_run *run) { return run && run->run ? hk_run_view(run->run) : NULL; }
static const hk_model *model_of(const hooke_run *run) { return view_of(run) ? view_of(run)->model : NULL; }

double hooke_time(const hooke_run *run) { return view_of(run) ? view_of(run)->t : NAN; }
double hooke_end(const hooke_run *run) { return run && run->run ? hk_run_end(run->run) : NAN; }
size_t hooke_count(const hooke_run *run) { return view_of(run) ? view_of(run)->n : 0; }
const double *hooke_positions(const hooke_run *run) { return view_of(run) ? view_of(run)->x : NULL; }
const double *hooke_velocities(const hooke_run *run) { return view_of(run) ? view_of(run)->v : NULL; }
const double *hooke_masses(const hooke_run *run) { return model_of(run) ? model_of(run)->mass : NULL; }
const uint32_t *hooke_ids(const hooke_run *run) { return model_of(run) ? model_of(run)->id : NULL; }
const uint32_t *hooke_order(const hooke_run *run) { return model_of(run) ? model_of(run)->by_id : NULL; }

const double *hooke_channel(const hooke_run *run, const char *name, size_t *size) {
  const hk_view *view = view_of(run);
  *size = 0;
  for (size_t k = 0; view && name && k < view->model->channels; k++) {
    const hk_channel *c = &view->model->channel[k];
    if (strcmp(c->name, name) != 0) continue;
    *size = c->size;
    return view->y + c->offset * view->n;
  }
  return NULL;
}

const char *hooke_channel_name(const hooke_run *run, size_t k) {
  const hk_model *model = model_of(run);
  return model && k < model->channels ? model->channel[k].name : NULL;
}

void hooke_energy(hooke_run *run, double *kinetic, double *potential, double *work) {
  double energy[3] = {NAN, NAN, NAN}, *to[3] = {kinetic, potential, work};
  hooke_surroundings own;
  hooke_enter(&own);
  if (view_of(run)) hk_run_energy(run->run, &energy[0], &energy[1], &energy[2]);
  hooke_leave(&own);
  for (int k = 0; k < 3; k++)
    if (to[k]) *to[k] = energy[k];
}

const char *hooke_measure_name(const hooke_run *run, size_t k) {
  if (!run || !run->run) return NULL;
  const hk_frame *frame = &run->run->judgement.last_frame;
  return k < frame->measures ? frame->measure_name[k] : NULL;
}

double hooke_measure(const hooke_run *run, size_t k) {
  return hooke_measure_name(run, k) ? run->run->judgement.last_frame.measure[k] : NAN;
}
