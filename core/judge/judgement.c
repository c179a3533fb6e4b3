/* Allocation of a judgement and release of its arrays: measures, samples, the last good state. */
#include "core/judge/judge.h"

#include <stdlib.h>

hk_status hk_judgement_open(hk_judgement *j, const hk_scene *scene, hk_error *error) {
  j->measure = calloc(scene->measures + 1, sizeof *j->measure);
  j->measure_name = calloc(scene->measures + 1, sizeof *j->measure_name);
  if (!j->measure || !j->measure_name) return hk_error_set(error, HK_NO_MEMORY, "no memory for the measures");
  for (size_t k = 0; k < scene->measures; k++) j->measure_name[k] = scene->measure[k].name;
  j->last_frame.measures = scene->measures;
  j->last_frame.measure_name = j->measure_name;
  j->last_frame.measure = j->measure;
  return HK_OK;
}

void hk_judgement_close(hk_judgement *j) {
  hk_snapshot_free(&j->last_good);
  hk_trajectory_free(&j->trajectory);
  free(j->measure);
  free(j->measure_name);
  free(j->slope[0]);
  free(j->slope[1]);
  free(j->unresolved);
  free(j->plugin_time);
}
